#include "core/light/rect_light.h"

#include <algorithm>
#include <array>

#include "core/light/polygon.h"

namespace relight {
namespace {

std::array<Point3, 4> corners_of(const RectLight& light)
{
    const Vec3 u = light.edge_u * 0.5, v = light.edge_v * 0.5;
    return {light.center - u - v, light.center + u - v, light.center + u + v, light.center - u + v};
}

bool shines_toward(const RectLight& light, Point3 p)
{
    const double height = dot(p - light.center, normalize(cross(light.edge_u, light.edge_v)));
    return height > 0.0 || (light.two_sided && height < 0.0);
}

/// What is seen of a half that is drawn in proportion to its solid angle.
LightSample part_of(LightSample half, double share)
{
    if (!half.wi) { return {}; }
    half.L = Rgb::grey(1.0);
    half.pdf *= share;
    return half;
}

}  // namespace

double area(const RectLight& light)
{
    return length(cross(light.edge_u, light.edge_v));
}

double irradiance(const RectLight& light, Point3 p, Dir3 n)
{
    std::array<Point3, 4> corners = corners_of(light);
    const double front = polygon_irradiance(corners, p, n);
    if (!light.two_sided || front > 0.0) { return front; }
    std::reverse(corners.begin(), corners.end());
    return polygon_irradiance(corners, p, n);
}

RectView::RectView(const RectLight& light, Point3 p)
{
    if (!shines_toward(light, p)) { return; }
    const std::array<Point3, 4> at = corners_of(light);
    halves_ = {view({at[0], at[1], at[2]}, p), view({at[0], at[2], at[3]}, p)};
    directions_.whole = halves_[0].solid_angle + halves_[1].solid_angle;
    if (by_area() || !is_seen()) { return; }
    directions_.halves = {halves_[0].spherical(), halves_[1].spherical()};
    directions_.normal = halves_[0].normal;
    directions_.height = std::abs(halves_[0].volume);
    double& farthest = directions_.farthest;
    for (const Point3 corner : at) { farthest = std::max(farthest, length(corner - p)); }
}

LightSample RectView::sample(Sample2 s) const
{
    if (!is_seen()) { return {}; }
    if (!by_area()) { return sample_direction(s); }
    const double at = s.u * directions_.whole;
    const bool first = at < halves_[0].solid_angle;
    const TriangleView& half = halves_[first ? 0 : 1];
    s.u = std::min((first ? at : at - halves_[0].solid_angle) / half.solid_angle,
                   RectDirections::below_one);
    return part_of(relight::sample(half, s), half.solid_angle / directions_.whole);
}

LightSample RectView::look(Dir3 wi) const
{
    if (!is_seen()) { return {}; }
    for (const TriangleView& half : halves_) {
        const LightSample seen = relight::look(half, wi);
        if (seen.wi) { return part_of(seen, half.solid_angle / directions_.whole); }
    }
    return {};
}

LightSample sample(const RectLight& light, Point3 p, Sample2 s)
{
    return RectView(light, p).sample(s);
}

LightSample look(const RectLight& light, Point3 p, Dir3 wi)
{
    return RectView(light, p).look(wi);
}

}  // namespace relight
