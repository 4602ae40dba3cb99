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

/// z is n, x as near to `along` as can be; without that, frame_around(n).
Frame frame_along(Dir3 n, Vec3 along)
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
    const Triangle& t = surface.triangles[hit.primitive];
    const std::array<double, 3> b{1.0 - hit.u - hit.v, hit.u, hit.v};
    std::array<Point3, 3> corner;
    std::array<Dir3, 3> normal;
    Vec3 n, tangent;
    double bitangent_sign = 0.0;
    double spacing = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < 3; ++i) {
        corner[i] = stage.mesh->positions[t[i]];
        normal[i] = normals[t[i]];
        n += Vec3(normal[i]) * b[i];
        if (!surface.tangents.empty()) {
            const auto& x = surface.tangents[t[i]];
            tangent += direction_of(x) * b[i];
            bitangent_sign += static_cast<double>(x[3]) * b[i];
        }
        spacing = std::min(spacing, static_cast<double>(surface.spacing[t[i]]));
    }
    Receiver at;
    at.p = corner[0] + (corner[1] - corner[0]) * b[1] + (corner[2] - corner[0]) * b[2];
    at.ng = normalize(cross(corner[1] - corner[0], corner[2] - corner[0]));
    const Dir3 interpolated = normalize(n);
    const Dir3 smooth = interpolated ? interpolated : at.ng;
    // Filed normals say which side is the front.
    if (dot(at.ng, smooth) < 0.0) { at.ng = -at.ng; }
    at.frame =
        frame_along(bent(stage, hit, smooth, tangent, bitangent_sign < 0.0 ? -1.0 : 1.0), tangent);
    at.lifted =
        terminator == Terminator::Smooth ? onto_tangent_planes(at.p, corner, normal, b) : at.p;
    at.clear = stage.bvh->clearance(spacing);
    return at;
}

}  // namespace

std::optional<Seen> see(const Stage& stage, const Scene& scene, Point3 origin, Dir3 direction,
                        const Hit& hit)
{
    const Dir3 wo = -direction;
    Seen seen;
    Receiver& at = seen.at;
    const Splat splat = hit.is_point ? splat_at(stage, origin, direction, hit) : Splat{};
    at =
        hit.is_point ? on_point(stage, splat) : on_triangle(stage, scene.transport.terminator, hit);
    if (!at.ng) { return {}; }
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
        if (!n) { return {}; }
        at.frame = frame_along(n, at.frame.x);
    }
    seen.wo = at.frame.to_local(wo);
    seen.material = material_at(stage, scene, hit);
    const bool is_white = stage.mesh->colors.empty() && stage.mesh->maps.empty();
    seen.color = hit.is_point ? splat.color : is_white ? Rgb::grey(1.0) : color_at(stage, hit);
    return seen;
}

bool is_above(const Seen& seen, Dir3 wi)
{
    const Receiver& at = seen.at;
    if (!(dot(at.frame.n, wi) > 0.0)) { return false; }
    return dot(at.ng, wi) > 0.0 || dot(at.lifted - at.p, at.ng) > 2.0 * at.clear.offset;
}

}  // namespace relight
