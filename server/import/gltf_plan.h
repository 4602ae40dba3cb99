#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "server/import/gltf.h"
#include "server/import/gltf_primitive.h"
#include "server/import/gltf_scene.h"

namespace relight::gltf {

/// Every primitive of every node that shows one, instances unfolded, in the order of the mesh.
struct Plan {
    struct Piece {
        std::uint32_t node = 0, mesh = 0, primitive = 0, instance = 0;
        Affine to_world = unmoved;
        std::uint64_t first_vertex = 0, first_face = 0;
    };
    std::vector<Piece> pieces;
    std::map<std::uint32_t, std::vector<PrimitiveShape>> meshes;  ///< those that are shown
    std::uint64_t vertices = 0, faces = 0;

    const PrimitiveShape& shape(const Piece& piece) const
    {
        return meshes.at(piece.mesh)[piece.primitive];
    }
};

/// Counts all before anything of its size is allocated.
/// Errors: TooManyVertices, TooManyFaces, NoGeometry, and those of primitive_shape().
Plan make_plan(File& file, const SceneGraph& scene, const GltfLimits& limits);

}  // namespace relight::gltf
