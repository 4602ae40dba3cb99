#pragma once

#include <array>
#include <vector>

#include "core/geometry/surface.h"

namespace relight {

/// Surface::tangents as filed, else from the mesh's texture coordinates (those of the corners,
/// where it has them), for a surface with triangles and normals. Empty: the mesh has none.
std::vector<std::array<float, 4>> tangents_of(const Mesh& mesh, const Surface& surface);

}  // namespace relight
