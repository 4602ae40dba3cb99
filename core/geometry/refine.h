#pragma once

#include <cstdint>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/geometry/mesh.h"

namespace relight {

/// The mesh with no edge longer than `max_edge` [scene units, > 0]: longer ones are halved, round
/// after round, and their triangles split to fit, so that neighbours keep meeting edge to edge
/// whatever the topology. (An edge stays longer if its ends are neighbouring numbers.) The vertices
/// of the file come first, in their order; new ones lie in the middle of an edge, with the mean of
/// what its ends have. Polygons become triangles first. A note says what became of the mesh; one
/// without longer edges, and a cloud, stay as they are.
/// Errors: TooManyVertices, TooManyFaces (it would take more than these), Cancelled.
Result<Mesh> refine(const Mesh& mesh, double max_edge, std::uint64_t most_vertices,
                    std::uint64_t most_faces, Progress& progress);

}  // namespace relight
