#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/shade/shade.h"
#include "server/answer_parts.h"
#include "server/picture.h"
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

/// The answer is the file that the mesh came as, with what was computed added: a LAS, or a GLB of a
/// glTF that was not refined.
bool keeps_source(Format format, const Mesh& mesh);

/// The mesh with what was asked for, in any format but the images. The exposure is chosen here if
/// the display says so. It is written while it is sent; the Encoding holds what it needs, and knows
/// its length but for text. `last`: no better message follows (of raw fields).
/// Errors: those of encode_las() and add_to_gltf(); NotAvailable (a GLB beyond 4 GiB).
Result<Encoding> encode_mesh(const std::shared_ptr<Lit>& lit, Display display, const Output& output,
                             Format format, bool last, unsigned threads, Progress& progress);

}  // namespace relight
