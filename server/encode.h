#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/preview/preview.h"
#include "core/shade/raytrace.h"
#include "core/shade/shade.h"
#include "server/request.h"

namespace relight {

/// A lit mesh, and all that its answer is made of.
struct Lit {
    Stage stage;
    Scene scene;
    Transport transport;
    Shaded shaded;
    std::vector<std::string> warnings;
    std::vector<std::byte> source;  ///< the mesh's own file, where keeps_source() says so
};

/// A text or file that is there already.
Encoding sent_whole(std::string bytes);

/// The answer is the file that the mesh came as, with what was computed added: a LAS, or a GLB of a
/// glTF that was not refined.
bool keeps_source(Format format, const Mesh& mesh);

/// The mesh with what was asked for, in any format but the images. The exposure is chosen here if
/// the display says so. Binary PLY and raw fields are written while they are sent; the Encoding
/// holds what it needs. `last`: no better message follows (of raw fields).
/// Errors: those of write_las() and add_to_gltf(); Internal.
Result<Encoding> encode_mesh(const std::shared_ptr<const Lit>& lit, Display display,
                             const Output& output, Format format, bool last, unsigned threads,
                             Progress& progress);

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
