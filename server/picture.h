#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/shade/raytrace.h"
#include "core/trace/stage.h"
#include "server/request.h"

namespace relight {

/// A ray-traced picture's radiance: as HDR, or as EXR with its coverage (A) and a layer for each
/// quantity asked for: standard_error, normal, and per_light_<name> for each light.
std::string encode_radiance(const Rendered& rendered, const Scene& scene, const Output& output,
                            Format format, const std::vector<std::string>& warnings);

/// A ray-traced picture as PNG or JPEG.
std::string encode_image(const Image& image, Display display, const Output& output, Format format,
                         unsigned threads, Progress& progress);

/// The surface's vertex colours as VTK draws them, as PNG or JPEG. Error Internal without a GL
/// driver.
Result<std::string> encode_preview(const Stage& stage, const Scene& scene,
                                   std::span<const Rgbf> radiance, Display display,
                                   const Output& output, Format format, unsigned threads,
                                   Progress& progress);

}  // namespace relight
