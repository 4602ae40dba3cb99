#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/vec.h"
#include "server/import/gltf_file.h"

namespace relight::gltf {

/// p' = A p + t, row by row: A's row and t's component, three times.
using Affine = std::array<double, 12>;

inline constexpr Affine unmoved{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

/// First `inner`, then `outer`.
Affine compose(const Affine& outer, const Affine& inner);

/// A v: a displacement.
constexpr Vec3 turn(const Affine& m, Vec3 v)
{
    return {m[0] * v.x + m[1] * v.y + m[2] * v.z, m[4] * v.x + m[5] * v.y + m[6] * v.z,
            m[8] * v.x + m[9] * v.y + m[10] * v.z};
}

/// A p + t: a place.
constexpr Point3 move(const Affine& m, Point3 p)
{
    const Vec3 turned = turn(m, {p.x, p.y, p.z});
    return {turned.x + m[3], turned.y + m[7], turned.z + m[11]};
}

/// How a surface's directions follow its points.
struct Turned {
    /// Of normals: the cofactors of A, A's determinant's sign in front. cof(A) (u x v) = Au x Av
    /// holds for singular matrices too, and a mirror must not turn normals inside out. Scaled so
    /// that nothing overflows; zero where A flattens to a line.
    Affine normals = unmoved;
    bool mirrored = false;  ///< det A < 0: faces are to be wound the other way round
};
Turned turned(const Affine& m);

/// Translation, rotation (x y z w, scaled to a unit quaternion) and scale.
/// Refuses a rotation of length zero, naming `where`.
Affine from_trs(std::span<const double, 3> translation, std::span<const double, 4> rotation,
                std::span<const double, 3> scale, const std::string& where);

/// From sixteen numbers, column by column, with 0 0 0 1 for the last row: refuses another one,
/// naming `where`.
Affine from_columns(std::span<const double, 16> columns, const std::string& where);

/// What the file shows, and where.
struct SceneGraph {
    std::vector<std::uint32_t> shown;  ///< nodes of the scene, depth first
    std::vector<Affine> to_world;      ///< one a node of the file; finite, moderate numbers
};

/// The default scene, else the first, else every root node.
/// Errors: MalformedBody (cycles, nodes with two parents, matrices that are not affine),
/// IndexOutOfRange, CoordinateTooLarge.
SceneGraph read_scene(const File& file);

}  // namespace relight::gltf
