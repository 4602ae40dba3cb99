#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/geometry/mesh.h"
#include "server/import/gltf_primitive.h"
#include "server/import/gltf_scene.h"

namespace relight::gltf {

/// Where a primitive goes: in the world, and in the mesh's arrays, which are large enough.
struct Place {
    std::string where;  ///< the node's, for messages
    Affine to_world = unmoved;
    std::vector<Affine> joints;   ///< of its skin, at rest; none: rigid
    std::vector<double> weights;  ///< of its morph targets; none: all 0
    std::uint64_t first_vertex = 0, first_face = 0;
};

/// Writes a primitive's vertices and faces into `mesh`, moved to the world: targets are added, then
/// joints or the node's matrix move it. Attributes that it lacks are left as they are. Normals and
/// tangents become unit, or zero where they have no direction.
/// Errors: CoordinateTooLarge, IndexOutOfRange (a joint).
void put(const Primitive& primitive, const Place& place, Mesh& mesh);

}  // namespace relight::gltf
