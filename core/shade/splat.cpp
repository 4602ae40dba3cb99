#include "core/shade/splat.h"

#include <algorithm>
#include <cmath>

#include "core/transport/receiver.h"

namespace relight {
namespace {

/// Sums over discs that become their mean.
struct Blend {
    double weight = 0.0, distance = 0.0, spacing = 0.0;
    Vec3 n;
    Rgb color;

    void add(double w, const Stage& stage, std::uint32_t point, double t)
    {
        weight += w;
        distance += w * t;
        spacing += w * static_cast<double>(stage.surface->spacing[point]);
        n += Vec3(stage.surface->normals[point]) * w;
        color += vertex_color(stage, point) * w;
    }
};

/// n, or next to it what is on the side of `side`.
Dir3 leaned(Dir3 n, Dir3 side)
{
    constexpr double least_cosine = 1e-3;
    const double cosine = dot(n, side);
    return cosine < least_cosine ? normalize(Vec3(n) + Vec3(side) * (least_cosine - cosine)) : n;
}

}  // namespace

Splat splat_at(const Stage& stage, Point3 origin, Dir3 direction, const Hit& hit)
{
    const Surface& surface = *stage.surface;
    const Dir3 facing = surface.normals[hit.primitive];
    const double R = stage.bvh->disc_radius(hit.primitive);
    // R deep along the normal; of what is seen edge on, no further than 4 R.
    const double depth = R / std::max(0.25, std::abs(dot(facing, direction)));
    const double before = 1e-3 * R;  // discs of one plane are met at once, but for rounding
    Blend blend;
    for (const std::uint32_t point : stage.bvh->points_along(
             {origin, direction, std::max(0.0, hit.distance - before), hit.distance + depth})) {
        const Dir3 n = surface.normals[point];
        const Vec3 to_centre = stage.mesh->positions[point] - origin;
        const double t = dot(to_centre, n) / dot(direction, n);
        if (dot(n, facing) <= 0.0 || !is_finite(t)) { continue; }
        const double r = length(Vec3(direction) * t - to_centre) / stage.bvh->disc_radius(point);
        const double inside = std::max(0.0, 1.0 - r * r);
        const double near = std::clamp(1.0 - (t - hit.distance) / depth, 0.0, 1.0);
        blend.add(inside * inside * near, stage, point, t);
    }
    if (!(blend.weight > 0.0)) {  // on a rim, where no other disc is
        blend = {};
        blend.add(1.0, stage, hit.primitive, hit.distance);
    }
    const bool front = dot(facing, direction) <= static_cast<double>(surface.bend[hit.primitive]);
    const Dir3 to_front = front ? -direction : direction;
    return {origin + Vec3(direction) * (blend.distance / blend.weight),
            leaned(normalize(blend.n), to_front), blend.color * (1.0 / blend.weight),
            blend.spacing / blend.weight};
}

}  // namespace relight
