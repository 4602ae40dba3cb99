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
    std::span<const std::byte> source;  ///< the mesh's own file, where keeps_source() says so
};

/// The answer is the file that the mesh came as, with what was computed added: a LAS, or a GLB of a
/// glTF that was not refined.
bool keeps_source(Format format, const Mesh& mesh);

/// The mesh with what was asked for, in any format but the images. The exposure is chosen here if
/// the display says so.   Errors: those of write_las() and add_to_gltf(); Internal.
Result<std::string> encode_mesh(const Lit& lit, Display display, const Quantities& wanted,
                                Format format, unsigned threads, Progress& progress);

/// "units" and "view" of JSON answers.
std::string units_json(Units units);
std::string view_json(const Scene& scene);

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
