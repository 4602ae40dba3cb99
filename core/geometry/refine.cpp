#include "core/geometry/refine.h"

namespace relight {

Result<Mesh> refine(const Mesh& mesh, double /*max_edge*/, std::uint64_t /*most_vertices*/,
                    std::uint64_t /*most_faces*/, Progress& /*progress*/)
{
    return mesh;
}

}  // namespace relight
