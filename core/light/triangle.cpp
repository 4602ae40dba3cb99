#include "core/light/triangle.h"

#include <algorithm>
#include <cmath>

#include "core/base/warp.h"

namespace relight {
namespace {

/// Below, directions within the triangle have fewer than about twelve digits, and the density of
/// points of equal area hardly varies [sr].
constexpr double least_solid_angle = 1e-7;

/// A place nearer to the triangle than this fraction of its longest edge draws the directions of a
/// place at that height: nearer, the corners are on one great circle, in double, and which part of
/// the hemisphere they enclose is rounding.
constexpr double least_height = 1e-9;

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

/// Uniform in the spherical triangle: a corner C' on the arc from A to C cuts off the share u of
/// the angle; then along the arc from B to C', uniform in the cosine (Arvo 1995). With
/// C' = A cos(tau) + T sin(tau) and t = tan(tau / 2), Van Oosterom & Strackee's formula for A, B,
/// C' becomes tan(Omega' / 2) = t |A . (B x T)| / (1 + A . B + t B . T), solved for t without the
/// angles and the arc cosines whose differences lose the digits of small triangles.
Dir3 in_spherical_triangle(Dir3 A, Dir3 B, Dir3 C, double solid_angle, Sample2 s)
{
    // Unit, perpendicular to `from`, toward `to`.
    const auto across = [](Dir3 from, Vec3 to) -> Vec3 {
        const Vec3 chord = to - from;
        return normalize(chord - Vec3(from) * dot(from, chord));
    };
    const Vec3 T = across(A, C);
    const double half = 0.5 * s.u * solid_angle;
    const Vec3 both = Vec3(A) + B;
    const double up = std::sin(half) * 0.5 * dot(both, both);
    const double down =
        std::abs(dot(cross(A, Vec3(B) - A), T)) * std::cos(half) - std::sin(half) * dot(B, T);
    const Vec3 corner = normalize(Vec3(A) * ((down - up) * (down + up)) + T * (2.0 * up * down));
    const Vec3 chord = corner - B;
    const double k = s.v * 0.5 * dot(chord, chord);  // 1 - cos of the angle from B
    return normalize(Vec3(B) * (1.0 - k) + across(B, corner) * std::sqrt(k * (2.0 - k)));
}

}  // namespace

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
    return seen(view, in_spherical_triangle(normalize(view.a), normalize(view.b), normalize(view.c),
                                            view.solid_angle, s));
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
