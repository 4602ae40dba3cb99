#include "core/light/rect_light.h"

#include <algorithm>
#include <array>

#include "core/light/polygon.h"
#include "core/light/triangle.h"

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

std::array<TriangleView, 2> halves_of(const RectLight& light, Point3 p)
{
    const std::array<Point3, 4> at = corners_of(light);
    return {view({at[0], at[1], at[2]}, p), view({at[0], at[2], at[3]}, p)};
}

constexpr double below_one = 1.0 - 0x1p-33;

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

LightSample sample(const RectLight& light, Point3 p, Sample2 s)
{
    if (!shines_toward(light, p)) { return {}; }
    const std::array<TriangleView, 2> halves = halves_of(light, p);
    const double whole = halves[0].solid_angle + halves[1].solid_angle;
    if (whole == 0.0) { return {}; }
    // s.u chooses the half and is then spread over it: points that are well apart stay so.
    const double at = s.u * whole;
    const bool first = at < halves[0].solid_angle;
    const TriangleView& half = halves[first ? 0 : 1];
    s.u = std::min((first ? at : at - halves[0].solid_angle) / half.solid_angle, below_one);
    return part_of(sample(half, s), half.solid_angle / whole);
}

LightSample look(const RectLight& light, Point3 p, Dir3 wi)
{
    if (!shines_toward(light, p)) { return {}; }
    const std::array<TriangleView, 2> halves = halves_of(light, p);
    const double whole = halves[0].solid_angle + halves[1].solid_angle;
    for (const TriangleView& half : halves) {
        const LightSample seen = look(half, wi);
        if (seen.wi) { return part_of(seen, half.solid_angle / whole); }
    }
    return {};
}

}  // namespace relight
