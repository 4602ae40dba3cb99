#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/geometry/mesh.h"

namespace relight {

/// What an OBJ file hangs on the corners of its faces: corners name positions, texture coordinates
/// and normals apart, while a Mesh keeps one normal a vertex.
struct ObjCorners {
    static constexpr std::uint32_t none = 0xFFFFFFFF;  ///< a corner that names none

    std::vector<std::array<float, 2>> uvs;  ///< one a `vt`
    std::vector<Vec3> normals;              ///< one a `vn`
    std::vector<std::uint32_t> uv_of;      ///< one a corner, into `uvs`; empty: no corner names one
    std::vector<std::uint32_t> normal_of;  ///< one a corner, into `normals`; empty likewise
};

/// The mesh with its texture coordinates: `uvs` where the corners of each vertex agree, else
/// `corner_uvs`. What no corner names is (0, 0), and a note says how many. Indices are in range.
Mesh with_uvs(Mesh mesh, const ObjCorners& filed);

/// The mesh with its normals: what the corners of a vertex agree upon, as filed; where they differ,
/// the normalised sum of the distinct ones, and a note says at how many vertices. A vertex without
/// one has the zero vector. Without faces, as many `vn` as `v` are the normals of a point cloud.
Mesh with_normals(Mesh mesh, const ObjCorners& filed);

}  // namespace relight
