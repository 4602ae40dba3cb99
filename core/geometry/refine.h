#pragma once

#include <cstdint>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/geometry/mesh.h"

namespace relight {

/// The mesh with no edge longer than `max_edge` [scene units]: longer ones are halved, round after
/// round, and their triangles split to fit, so that neighbours keep meeting edge to edge whatever
/// the topology. The vertices of the file come first, in their order; new ones lie in the middle of
/// an edge, with the mean of what its ends have. Polygons become triangles first.
/// Errors: TooManyVertices, TooManyFaces (it would take more than these), Cancelled.
Result<Mesh> refine(const Mesh& mesh, double max_edge, std::uint64_t most_vertices,
                    std::uint64_t most_faces, Progress& progress);

}  // namespace relight
