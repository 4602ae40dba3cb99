#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/rgb.h"
#include "core/base/vec.h"
#include "core/texture/material_maps.h"

namespace relight {

/// Polygons as filed, corner after corner.
struct Faces {
    std::vector<std::uint32_t> indices;  ///< vertex of each corner
    std::vector<std::uint32_t>
        offsets;  ///< face f is indices[offsets[f] .. offsets[f+1]); empty: all triangles

    std::size_t count() const { return offsets.empty() ? indices.size() / 3 : offsets.size() - 1; }
    std::size_t begin(std::size_t face) const { return offsets.empty() ? 3 * face : offsets[face]; }
    std::size_t end(std::size_t face) const
    {
        return offsets.empty() ? 3 * face + 3 : offsets[face + 1];
    }
};

/// A run of vertices as a glTF holds it: one primitive of the mesh of one node.
struct GltfPiece {
    std::uint32_t node = 0;       ///< of the file
    std::uint32_t primitive = 0;  ///< of the node's mesh
    std::uint32_t instance = 0;   ///< of EXT_mesh_gpu_instancing; 0 without
    std::uint32_t first_vertex = 0, vertices = 0;
};

/// A mesh or point cloud as a reader found it: checked, nothing repaired, order and counts the
/// client's. Every index is in range and every coordinate finite and below `largest_coordinate`.
/// Arrays beside `positions` are empty or have the stated length.
struct Mesh {
    std::string format;             ///< "ply", "glb", "las" …; "json": sent in the request
    std::vector<Point3> positions;  ///< V
    /// Points that the file keeps a place for, but says nothing of (NaN), ascending: unlit, and no
    /// part of any geometry. Their position is another point's. Clouds only.
    std::vector<std::uint32_t> absent;
    bool double_positions = false;  ///< float would lose what the file says: write them as double
    Faces faces;                    ///< none: a point cloud
    std::vector<Vec3> normals;      ///< V, as filed (need not be unit; zero: none)
    std::vector<Rgbf>
        colors;  ///< V, linear Rec.709 (8 and 16 bit files are sRGB-decoded, floats linear)
    std::vector<Uv> uvs;         ///< V
    std::vector<Uv> uvs_1;       ///< V: a second set, for textures that ask for it
    std::vector<Uv> corner_uvs;  ///< one a corner, where a vertex has several (OBJ)
    /// V, as filed: unit tangents along increasing u, and the sign of the bitangent
    /// (cross(normal, tangent) times it). Zero: none.
    std::vector<std::array<float, 4>> tangents;
    std::vector<std::string> materials;  ///< names, in order of first use
    std::vector<MaterialMaps> maps;      ///< one each of `materials`, or empty: no textures
    std::vector<Texture> textures;       ///< that the maps name
    std::vector<std::uint32_t>
        face_materials;               ///< F, into `materials`; empty if the file names none
    std::optional<Point3> viewpoint;  ///< whence a cloud was scanned, if the file says so
    std::vector<GltfPiece> pieces;    ///< of a glTF, in the order of the vertices
    std::vector<std::string>
        notes;  ///< what the reader saw and left out ("unused vt", "mtllib ignored")
};

/// |coordinate| beyond this is refused: squares and distances must stay finite, and
/// single-precision rays too (Embree stops the process from 1.8e18 on).
inline constexpr double largest_coordinate = 1e15;

}  // namespace relight
