#include "core/light/triangle.h"

#include <algorithm>
#include <cmath>

namespace relight {
namespace {

/// tan(Omega / 2) = a . (b x c) / (abc + (a . b) c + (b . c) a + (c . a) b)
double solid_angle_of(Vec3 a, Vec3 b, Vec3 c, double volume)
{
    if (volume == 0.0) { return 0.0; }
    const double la = length(a), lb = length(b), lc = length(c);
    return 2.0 * std::atan2(std::abs(volume),
                            la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

/// The corners, edges and volume. The normal is that of the edges as they were given: the corners
/// of a far triangle are nearly one vector.
TriangleView seen_from(const std::array<Point3, 3>& triangle, Point3 p)
{
    TriangleView view;
    view.a = triangle[0] - p;
    view.b = triangle[1] - p;
    view.c = triangle[2] - p;
    view.normal = cross(triangle[1] - triangle[0], triangle[2] - triangle[0]);
    view.volume = dot(view.a, view.normal);
    view.solid_angle = solid_angle_of(view.a, view.b, view.c, view.volume);
    return view;
}

/// What is seen along wi. The distance is that to the triangle's plane, but no farther than the
/// farthest corner, whatever the rounding of a grazing direction.
LightSample seen(const TriangleView& view, Dir3 wi)
{
    const double down = std::abs(dot(wi, view.normal)), height = std::abs(view.volume);
    double distance = height / down;
    const auto squared = [](Vec3 v) { return dot(v, v); };
    const double farthest2 = std::max({squared(view.a), squared(view.b), squared(view.c)});
    if (!(distance * distance <= farthest2)) { distance = std::sqrt(farthest2); }
    // dA/dw / A = d^2 / (A cos), A cos = volume / (2 d)
    const double pdf =
        view.by_area ? 2.0 * distance * distance * distance / height : 1.0 / view.solid_angle;
    if (!wi || !(pdf > 0.0) || !is_finite(pdf)) { return {}; }  // beyond the range of double
    return {wi, distance, {}, pdf};
}

}  // namespace

SphericalTriangle::SphericalTriangle(Dir3 a, Dir3 b, Dir3 c, double angle)
    : solid_angle(angle), A(a), B(b)
{
    const Vec3 chord = Vec3(c) - A;
    T = normalize(chord - A * dot(A, chord));
    T = normalize(T - A * dot(A, T));  // again: C may be nearly A, or opposite
    const Vec3 both = A + B;
    sum = 0.5 * dot(both, both);
    sine = std::abs(dot(cross(A, B - A), T));
    b_dot_t = dot(B, T);
}

SphericalTriangle TriangleView::spherical() const
{
    return {normalize(a), normalize(b), normalize(c), solid_angle};
}

TriangleView view(const std::array<Point3, 3>& triangle, Point3 p)
{
    TriangleView view = seen_from(triangle, p);
    view.by_area = view.solid_angle < least_solid_angle;
    if (view.by_area) { return view; }

    const auto squared = [](Vec3 v) { return dot(v, v); };
    const double longest2 =
        std::max({squared(view.b - view.a), squared(view.c - view.a), squared(view.c - view.b)});
    const double normal2 = squared(view.normal);
    const double least2 = least_height * least_height * longest2 * normal2;
    if (view.volume * view.volume < least2) {
        const double lifted = std::copysign(std::sqrt(least2), view.volume);
        const Vec3 lift = view.normal * ((lifted - view.volume) / normal2);
        for (Vec3* corner : {&view.a, &view.b, &view.c}) { *corner += lift; }
        view.solid_angle = solid_angle_of(view.a, view.b, view.c, lifted);
    }
    return view;
}

LightSample sample(const TriangleView& view, Sample2 s)
{
    if (view.solid_angle == 0.0) { return {}; }
    if (view.by_area) {
        const Sample2 at = warp::triangle(s);
        return seen(view, normalize(view.a + (view.b - view.a) * at.u + (view.c - view.a) * at.v));
    }
    return seen(view, view.spherical().direction(s));
}

LightSample look(const TriangleView& view, Dir3 wi)
{
    if (view.solid_angle == 0.0) { return {}; }
    const double side = view.volume > 0.0 ? 1.0 : -1.0;
    const auto inside = [&](Vec3 from, Vec3 to) {
        return side * dot(cross(from, to - from), wi) >= 0.0;
    };
    if (!(inside(view.a, view.b) && inside(view.b, view.c) && inside(view.c, view.a))) {
        return {};
    }
    return seen(view, wi);
}

double solid_angle(const std::array<Point3, 3>& triangle, Point3 p)
{
    return seen_from(triangle, p).solid_angle;
}

LightSample sample_triangle(const std::array<Point3, 3>& triangle, Point3 p, Sample2 s)
{
    return sample(view(triangle, p), s);
}

LightSample look_at_triangle(const std::array<Point3, 3>& triangle, Point3 p, Dir3 wi)
{
    return look(view(triangle, p), wi);
}

}  // namespace relight
