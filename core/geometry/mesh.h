#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/rgb.h"
#include "core/base/vec.h"

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

/// A mesh or point cloud as a reader found it: checked, nothing repaired, order and counts the
/// client's. Every index is in range and every coordinate finite and below `largest_coordinate`.
/// Arrays beside `positions` are empty or have the stated length.
struct Mesh {
    std::string format;             ///< "ply", "obj", "off", "stl", "json"
    std::vector<Point3> positions;  ///< V
    bool double_positions = false;  ///< float would lose what the file says: write them as double
    Faces faces;                    ///< none: a point cloud
    std::vector<Vec3> normals;      ///< V, as filed (need not be unit; zero: none)
    std::vector<Rgbf>
        colors;  ///< V, linear Rec.709 (8 and 16 bit files are sRGB-decoded, floats linear)
    std::vector<std::array<float, 2>> uvs;  ///< V
    std::vector<std::array<float, 2>>
        corner_uvs;                      ///< one a corner, where a vertex has several (OBJ)
    std::vector<std::string> materials;  ///< names, in order of first use
    std::vector<std::uint32_t>
        face_materials;  ///< F, into `materials`; empty if the file names none
    std::vector<std::string>
        notes;  ///< what the reader saw and left out ("unused vt", "mtllib ignored")
};

/// |coordinate| beyond this is refused: squares and distances must stay finite, and
/// single-precision rays too (Embree stops the process from 1.8e18 on).
inline constexpr double largest_coordinate = 1e15;

}  // namespace relight
