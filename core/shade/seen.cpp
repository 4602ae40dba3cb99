#include "core/shade/seen.h"

#include <algorithm>
#include <array>

#include "core/geometry/normal_map.h"
#include "core/geometry/tangents.h"
#include "core/shade/splat.h"
#include "core/transport/textured.h"

namespace relight {
namespace {

/// The tangent planes of the corners, interpolated: p + sum b_i max(0, (p_i - p) . n_i) n_i. Where
/// a coarse mesh stands for a round one, shadow rays start from the round one. Contract section 7;
/// Hanika 2021 ("Hacking the shadow terminator").
Point3 onto_tangent_planes(Point3 p, const std::array<Point3, 3>& corner,
                           const std::array<Dir3, 3>& normal, const std::array<double, 3>& b)
{
    Vec3 lift;
    for (std::size_t i = 0; i < 3; ++i) {
        const double below = std::min(0.0, dot(p - corner[i], normal[i]));
        lift += Vec3(normal[i]) * (-below * b[i]);
    }
    return p + lift;
}

/// z is n, x as near to `along` as can be; without that, frame_around(n). By reference: what has
/// just been written number by number cannot be copied in wider pieces before it is in the cache.
Frame frame_along(const Dir3& n, const Vec3& along)
{
    if (along == Vec3{}) { return frame_around(n); }
    const Dir3 x = normalize(along - Vec3(n) * dot(along, n));
    if (!x) { return frame_around(n); }
    return {x, normalize(cross(n, x)), n};
}

Receiver on_point(const Stage& stage, const Splat& splat)
{
    return {splat.p, splat.p, frame_around(splat.n), splat.n, stage.bvh->clearance(splat.spacing)};
}

/// The interpolated normal as the normal map of the hit's group bends it there, if it has one.
Dir3 bent(const Stage& stage, const Hit& hit, Dir3 smooth, Vec3 tangent, double bitangent_sign)
{
    if (stage.surface->smooth_normals.empty()) { return smooth; }
    const FiledPlace place = filed_place(stage, hit);
    if (place.maps == nullptr || !place.maps->normal) { return smooth; }
    const TextureMap& map = *place.maps->normal;
    return bent_normal(smooth, tangent, bitangent_sign, stage.mesh->textures[map.texture],
                       *place.maps, place.uvs[map.uv_set]);
}

Receiver on_triangle(const Stage& stage, Terminator terminator, const Hit& hit)
{
    const Surface& surface = *stage.surface;
    const auto& normals = surface.smooth_normals.empty() ? surface.normals : surface.smooth_normals;
    const auto& positions = stage.mesh->positions;
    const auto [t0, t1, t2] = surface.triangles[hit.primitive];
    const std::array<double, 3> b{1.0 - hit.u - hit.v, hit.u, hit.v};
    const std::array<Point3, 3> corner{positions[t0], positions[t1], positions[t2]};
    const std::array<Dir3, 3> normal{normals[t0], normals[t1], normals[t2]};
    const Vec3 n = Vec3(normal[0]) * b[0] + Vec3(normal[1]) * b[1] + Vec3(normal[2]) * b[2];
    Vec3 tangent;
    double bitangent_sign = 0.0;
    if (!surface.tangents.empty()) {
        const std::array<std::uint32_t, 3> corners{t0, t1, t2};
        for (std::size_t i = 0; i < 3; ++i) {
            const auto& x = surface.tangents[corners[i]];
            tangent += direction_of(x) * b[i];
            bitangent_sign += static_cast<double>(x[3]) * b[i];
        }
    }
    const Vec3 ab = corner[1] - corner[0], ac = corner[2] - corner[0];
    const Point3 p = corner[0] + ab * b[1] + ac * b[2];
    const Dir3 face = normalize(cross(ab, ac));
    Dir3 smooth = normalize(n);
    if (!smooth) { smooth = face; }
    return {
        p, terminator == Terminator::Smooth ? onto_tangent_planes(p, corner, normal, b) : p,
        frame_along(bent(stage, hit, smooth, tangent, bitangent_sign < 0.0 ? -1.0 : 1.0), tangent),
        dot(face, smooth) < 0.0 ? -face : face,  // filed normals say which side is the front
        stage.bvh->clearance(static_cast<double>(
            std::min({surface.spacing[t0], surface.spacing[t1], surface.spacing[t2]})))};
}

}  // namespace

Seen see(const Stage& stage, const Scene& scene, Point3 origin, Dir3 direction, const Hit& hit)
{
    const Dir3 wo = -direction;
    const Splat splat = hit.is_point ? splat_at(stage, origin, direction, hit) : Splat{};
    const bool is_white = stage.mesh->colors.empty() && stage.mesh->maps.empty();
    Seen seen{
        hit.is_point ? on_point(stage, splat) : on_triangle(stage, scene.transport.terminator, hit),
        {},
        material_at(stage, scene, hit),
        hit.is_point ? splat.color
        : is_white   ? Rgb::grey(1.0)
                     : color_at(stage, hit),
        true};
    Receiver& at = seen.at;
    if (dot(at.ng, wo) < 0.0) {  // its back is seen: that side is lit and shown
        at.ng = -at.ng;
        at.frame = {at.frame.x, -at.frame.y, -at.frame.n};
        at.lifted = at.p;
        seen.front = false;
    }
    // An interpolated normal may lean away from a viewer who does see the surface: lean it back.
    constexpr double least_cosine = 1e-3;
    const double cos_o = dot(at.frame.n, wo);
    if (cos_o < least_cosine) {
        const Dir3 n = normalize(Vec3(at.frame.n) + Vec3(wo) * (least_cosine - cos_o));
        if (!n) { at.ng = {}; }
        at.frame = frame_along(n, at.frame.x);
    }
    seen.wo = at.frame.to_local(wo);
    return seen;
}

bool is_above(const Seen& seen, Dir3 wi)
{
    const Receiver& at = seen.at;
    if (!(dot(at.frame.n, wi) > 0.0)) { return false; }
    return dot(at.ng, wi) > 0.0 || dot(at.lifted - at.p, at.ng) > 2.0 * at.clear.offset;
}

}  // namespace relight
