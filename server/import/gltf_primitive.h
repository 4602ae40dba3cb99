#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/import/gltf_file.h"

namespace relight::gltf {

/// What a primitive draws.
enum class Drawn { Points, Lines, Triangles };

/// What a primitive announces; its arrays are not read yet.
struct PrimitiveShape {
    Drawn drawn{};
    std::uint64_t vertices = 0, faces = 0;
    std::uint64_t left_over = 0;  ///< corners behind the last whole triangle
    bool normals = false, tangents = false, colors = false, uvs = false, uvs_1 = false;
    std::size_t targets = 0;                ///< of morphing
    std::optional<std::uint32_t> material;  ///< of the file
};

/// Holds the counts of `primitive` against each other and against the file.
PrimitiveShape primitive_shape(File& file, const Node& primitive);

/// A primitive's arrays in the frame of its node: each of `vertices` elements, or empty.
struct Primitive {
    std::vector<float> positions, normals;  ///< three a vertex
    std::vector<float> tangents;            ///< four
    std::vector<float> colors;              ///< three, linear, [0, 1]
    std::vector<float> uvs, uvs_1;          ///< two
    std::vector<std::uint32_t> joints;      ///< `influences` a vertex, of the skin
    std::vector<float> weights;             ///< `influences` a vertex, not negative
    std::size_t influences = 0;
    struct Target {
        std::vector<float> positions, normals, tangents;  ///< displacements, three a vertex
    };
    std::vector<Target> targets;
    std::vector<std::uint32_t> indices;  ///< three a face
};

/// All of a primitive, unpacked. Check `shape` against limits first: it bounds what is allocated.
Primitive read_primitive(File& file, const Node& primitive, const PrimitiveShape& shape);

}  // namespace relight::gltf
