#include "core/geometry/tangents.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/filled.h"

namespace relight {
namespace {

/// Which set of texture coordinates tangents follow: the one that the normal map lies on.
const std::vector<Uv>& leading_uvs(const Mesh& mesh, std::size_t face)
{
    if (mesh.maps.empty() || mesh.face_materials.empty() || mesh.uvs_1.empty()) { return mesh.uvs; }
    const auto& normal = mesh.maps[mesh.face_materials[face]].normal;
    return mesh.uvs.empty() || (normal && normal->uv_set == 1) ? mesh.uvs_1 : mesh.uvs;
}

/// Texture coordinates of a triangle's three corners.
std::array<Uv, 3> uvs_of(const Mesh& mesh, const Surface& surface, std::size_t triangle)
{
    const Triangle& t = surface.triangles[triangle];
    const std::size_t face =
        surface.triangle_face.empty() ? triangle : surface.triangle_face[triangle];
    if (mesh.corner_uvs.empty()) {
        const std::vector<Uv>& uvs = leading_uvs(mesh, face);
        return {uvs[t[0]], uvs[t[1]], uvs[t[2]]};
    }
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

/// Of one triangle or the sum of some, weighted by area.
struct Along {
    Vec3 u;         ///< direction of dP/du
    Vec3 up;        ///< direction of dP/du x (-dP/dv): toward who sees the picture unmirrored
    double area{};  ///< twice

    Along& operator+=(const Along& other)
    {
        u += other.u;
        up += other.up;
        area += other.area;
        return *this;
    }
};

/// Of edges e_i = du_i P_u + dv_i P_v, eliminating P_v; e_1 x e_2 = (du_1 dv_2 - du_2 dv_1)
/// P_u x P_v. Zero where the coordinates span no area.
Along along(Vec3 e1, Vec3 e2, const std::array<Uv, 3>& uvs)
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
    const Dir3 u = normalize(e1 * dv2 - e2 * dv1);
    if (!u) { return {}; }
    const Vec3 doubled_area = cross(e1, e2);
    const double area = length(doubled_area);
    return {Vec3(u) * std::copysign(area, determinant),
            doubled_area * std::copysign(1.0, -determinant), area};
}

std::array<float, 4> tangent(Dir3 along_u, double sign)
{
    return {static_cast<float>(along_u.x()), static_cast<float>(along_u.y()),
            static_cast<float>(along_u.z()), static_cast<float>(std::copysign(1.0, sign))};
}

/// Of a vertex with normal n and this sum over its triangles; zero: none.
std::array<float, 4> computed(const Along& sum, Dir3 n)
{
    // Mirrored halves that meet cancel; what their roundings leave over is no direction.
    constexpr double least_agreement = 1e-6;
    const Vec3 in_plane = sum.u - Vec3(n) * dot(sum.u, n);
    if (!n || !(length(in_plane) > least_agreement * sum.area)) { return {}; }
    return tangent(normalize(in_plane), dot(sum.up, n));
}

/// The filed tangent, upright on the normal; one that points nowhere leaves the computed one.
std::array<float, 4> filed(const std::array<float, 4>& file, Dir3 n,
                           const std::array<float, 4>& computed)
{
    const Vec3 along_u = direction_of(file);
    const Dir3 x = normalize(along_u - Vec3(n) * dot(along_u, n));
    return n && x ? tangent(x, static_cast<double>(file[3])) : computed;
}

}  // namespace

std::vector<std::array<float, 4>> tangents_of(const Mesh& mesh, const Surface& surface,
                                              const VertexRanges& ranges, const Progress& progress)
{
    const bool from_uvs = !mesh.uvs.empty() || !mesh.uvs_1.empty() || !mesh.corner_uvs.empty();
    if (surface.triangles.empty() || (mesh.tangents.empty() && !from_uvs)) { return {}; }
    auto tangents = filled<std::array<float, 4>>(mesh.positions.size(), progress);
    ranges.each([&](const VertexRanges::Range& range) {
        auto sums = filled<Along>(range.size(), progress);
        for (const std::uint32_t b : range.blocks) {
            if (!from_uvs || progress.stopped()) { break; }
            const std::size_t first = b * VertexRanges::block;
            const std::size_t last =
                std::min(first + VertexRanges::block, surface.triangles.size());
            for (std::size_t i = first; i < last; ++i) {
                const Triangle& t = surface.triangles[i];
                if (std::none_of(t.begin(), t.end(), [&](unsigned v) { return range.has(v); })) {
                    continue;
                }
                const Point3 a = mesh.positions[t[0]];
                const Along one = along(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a,
                                        uvs_of(mesh, surface, i));
                for (const unsigned v : t) {
                    if (range.has(v)) { sums[v - range.begin] += one; }
                }
            }
        }
        if (progress.stopped()) { return; }
        for (std::size_t v = range.begin; v < range.end; ++v) {
            const Dir3 n = surface.normals[v];
            tangents[v] = computed(sums[v - range.begin], n);
            if (!mesh.tangents.empty()) { tangents[v] = filed(mesh.tangents[v], n, tangents[v]); }
        }
    });
    return tangents;
}

Frame shading_frame(const Surface& surface, std::size_t vertex)
{
    const Dir3 n = surface.normals[vertex];
    if (surface.tangents.empty() || !n) { return frame_around(n); }
    const Vec3 u = direction_of(surface.tangents[vertex]);
    const Dir3 x = normalize(u - Vec3(n) * dot(u, n));
    if (!x) { return frame_around(n); }
    return {x, normalize(cross(n, x)), n};
}

}  // namespace relight
