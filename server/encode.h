#pragma once

#include <string>
#include <vector>

#include "core/preview/preview.h"
#include "core/shade/raytrace.h"
#include "core/shade/shade.h"
#include "server/request.h"

namespace relight {

/// What encoding reads; all of it outlives the call.
struct Lit {
    const Stage& stage;
    const Scene& scene;
    const Transport& transport;
    const Shaded& shaded;
    std::vector<std::string> warnings;
};

/// The mesh with what was asked for, as PLY, NPZ or JSON. The exposure is chosen here if the
/// display says so.
std::string encode_mesh(const Lit& lit, Display display, const Quantities& wanted, Format format,
                        unsigned threads, Progress& progress);

/// "units" and "view" of JSON answers.
std::string units_json(Units units);
std::string view_json(const Scene& scene);

/// A ray-traced picture as EXR: its radiance (R G B), coverage (A), and a layer for each quantity
/// asked for: standard_error, normal, and per_light_<name> for each light.
std::string encode_layers(const Rendered& rendered, const Scene& scene, const Output& output,
                          const std::vector<std::string>& warnings);

/// A ray-traced picture as PNG.
std::string encode_image(const Image& image, Display display, const Output& output,
                         unsigned threads, Progress& progress);

/// The surface's vertex colours as VTK draws them, as PNG. Error Internal without a GL driver.
Result<std::string> encode_preview(const Stage& stage, const Scene& scene,
                                   std::span<const Rgbf> radiance, Display display,
                                   const Output& output, unsigned threads, Progress& progress);

}  // namespace relight
