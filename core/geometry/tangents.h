#pragma once

#include <array>
#include <vector>

#include "core/geometry/surface.h"
#include "core/geometry/vertex_ranges.h"

namespace relight {

/// Surface::tangents for a surface with triangles, normals and groups: those filed, made
/// perpendicular to the normal; where none is filed, dP/du of the texture coordinates (those of the
/// corners, where the mesh has them; the second set where the normal map of the face's group lies
/// on it). Empty: the mesh has neither.
///
/// The sign is that of glTF's bitangents, which run up the picture while v runs down: +1 where the
/// picture reads the right way round from the side that the normal is on, -1 where it is mirrored.
/// @param ranges of the surface's vertices
std::vector<std::array<float, 4>> tangents_of(const Mesh& mesh, const Surface& surface,
                                              const VertexRanges& ranges, const Progress& progress);

/// What a surface's tangent holds.
inline Vec3 direction_of(const std::array<float, 4>& tangent)
{
    return {static_cast<double>(tangent[0]), static_cast<double>(tangent[1]),
            static_cast<double>(tangent[2])};
}

}  // namespace relight
