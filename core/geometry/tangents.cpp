#include "core/geometry/tangents.h"

#include <algorithm>
#include <cmath>

namespace relight {
namespace {

using Uv = std::array<float, 2>;

/// Texture coordinates of a triangle's three corners.
std::array<Uv, 3> uvs_of(const Mesh& mesh, const Surface& surface, std::size_t triangle)
{
    const Triangle& t = surface.triangles[triangle];
    if (mesh.corner_uvs.empty()) { return {mesh.uvs[t[0]], mesh.uvs[t[1]], mesh.uvs[t[2]]}; }
    const std::size_t face =
        surface.triangle_face.empty() ? triangle : surface.triangle_face[triangle];
    const auto first =
        mesh.faces.indices.begin() + static_cast<std::ptrdiff_t>(mesh.faces.begin(face));
    const auto last =
        mesh.faces.indices.begin() + static_cast<std::ptrdiff_t>(mesh.faces.end(face));
    std::array<Uv, 3> uvs;
    for (std::size_t k = 0; k < 3; ++k) {  // which of the polygon's corners this is
        const auto corner = std::find(first, last, t[k]);
        uvs[k] = mesh.corner_uvs[static_cast<std::size_t>(corner - mesh.faces.indices.begin())];
    }
    return uvs;
}

/// Area-weighted direction of dP/du: of edges e_i = du_i P_u + dv_i P_v, eliminating P_v. Zero
/// where the coordinates span no area.
Vec3 along_u(Vec3 e1, Vec3 e2, const std::array<Uv, 3>& uvs)
{
    const auto difference = [&](std::size_t k, std::size_t axis) {
        return static_cast<double>(uvs[k][axis]) - static_cast<double>(uvs[0][axis]);
    };
    const double du1 = difference(1, 0), dv1 = difference(1, 1);
    const double du2 = difference(2, 0), dv2 = difference(2, 1);
    const double determinant = du1 * dv2 - du2 * dv1;
    // Coordinates filed as float: what cancels to their rounding is no area.
    constexpr double rounding = 1e-6;
    if (!(std::abs(determinant) > rounding * (std::abs(du1 * dv2) + std::abs(du2 * dv1)))) {
        return {};
    }
    const Vec3 direction = normalize(e1 * dv2 - e2 * dv1);
    return direction * std::copysign(length(cross(e1, e2)), determinant);
}

}  // namespace

std::vector<std::array<float, 4>> tangents_of(const Mesh& mesh, const Surface& surface)
{
    if (surface.triangles.empty() || (mesh.uvs.empty() && mesh.corner_uvs.empty())) { return {}; }
    std::vector<Vec3> sums(mesh.positions.size());
    std::vector<double> areas(mesh.positions.size());
    for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
        const Triangle& t = surface.triangles[i];
        const Point3 a = mesh.positions[t[0]];
        const Vec3 sum =
            along_u(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a, uvs_of(mesh, surface, i));
        for (const unsigned v : t) {
            sums[v] += sum;
            areas[v] += length(sum);
        }
    }
    // Mirrored halves that meet cancel; what their roundings leave over is no direction.
    constexpr double least_agreement = 1e-6;
    std::vector<std::array<float, 4>> tangents(sums.size());
    for (std::size_t v = 0; v < sums.size(); ++v) {
        const Dir3 n = surface.normals[v];
        const Vec3 in_plane = sums[v] - Vec3(n) * dot(sums[v], n);
        if (!n || !(length(in_plane) > least_agreement * areas[v])) { continue; }
        const Dir3 x = normalize(in_plane);
        tangents[v] = {static_cast<float>(x.x()), static_cast<float>(x.y()),
                       static_cast<float>(x.z()), 1.0F};
    }
    return tangents;
}

Frame shading_frame(const Surface& surface, std::size_t vertex)
{
    const Dir3 n = surface.normals[vertex];
    if (surface.tangents.empty() || !n) { return frame_around(n); }
    const auto& t = surface.tangents[vertex];
    const Vec3 along{static_cast<double>(t[0]), static_cast<double>(t[1]),
                     static_cast<double>(t[2])};
    const Dir3 x = normalize(along - Vec3(n) * dot(along, n));
    if (!x) { return frame_around(n); }
    return {x, normalize(cross(n, x)), n};
}

}  // namespace relight
