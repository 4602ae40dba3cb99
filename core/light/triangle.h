#pragma once

#include <array>
#include <cmath>

#include "core/base/warp.h"
#include "core/light/light_sample.h"

namespace relight {

/// Below, directions within the triangle have fewer than about twelve digits, and the density of
/// points of equal area hardly varies [sr].
inline constexpr double least_solid_angle = 1e-7;

/// A place nearer to the triangle than this fraction of its longest edge draws the directions of a
/// place at that height: nearer, the corners are on one great circle, in double, and which part of
/// the hemisphere they enclose is rounding.
inline constexpr double least_height = 1e-9;

/// Directions uniform in a spherical triangle, from what depends on its corners A, B, C alone: a
/// corner C' on the arc from A to C cuts off the share u of the angle; then along the arc from B to
/// C', uniform in the cosine (Arvo 1995). With C' = A cos(tau) + T sin(tau) and t = tan(tau / 2),
/// Van Oosterom & Strackee's formula for A, B, C' becomes
/// tan(Omega' / 2) = t |A . (B x T)| / (1 + A . B + t B . T), solved for t without the angles and
/// the arc cosines whose differences lose the digits of small triangles.
struct SphericalTriangle {
    double solid_angle = 0.0;
    Vec3 A, B;
    Vec3 T;                ///< unit, perpendicular to A, toward C
    double sum = 0.0;      ///< |A + B|^2 / 2 = 1 + A . B
    double sine = 0.0;     ///< |A . (B x T)|
    double b_dot_t = 0.0;  ///< B . T

    SphericalTriangle() = default;
    SphericalTriangle(Dir3 a, Dir3 b, Dir3 c, double angle);

    static constexpr double least = 1e-150;  // where rounding leaves nothing: at A, or at B

    Dir3 direction(Sample2 s) const { return direction(s.u * solid_angle, s.v); }
    /// That cuts off `angle` of the solid angle.
    Dir3 direction(double angle, double v) const { return toward(corner(angle), v); }
    /// C', and the direction at v on the arc from B to it.
    Vec3 corner(double angle) const
    {
        const warp::SineCosine eighth = warp::sine_cosine(0.125 * angle);
        const double s4 = 2.0 * eighth.sine * eighth.cosine;
        const double c4 = 1.0 - 2.0 * eighth.sine * eighth.sine;
        const double up = 2.0 * s4 * c4 * sum;  // sin(Omega' / 2) (1 + A . B)
        const double down = sine * ((c4 - s4) * (c4 + s4)) - 2.0 * s4 * c4 * b_dot_t + least;
        // cos(tau) and sin(tau) of tan(tau / 2) = up / down
        const double over = 1.0 / (down * down + up * up);
        return A * ((down - up) * (down + up) * over) + T * (2.0 * up * down * over);
    }
    Dir3 toward(Vec3 corner, double v) const
    {
        const Vec3 chord = corner - B;
        const double chord2 = dot(chord, chord);
        const double k = v * 0.5 * chord2;               // 1 - cos of the angle from B
        const Vec3 across = chord + B * (0.5 * chord2);  // perpendicular to B, for |corner| = 1
        const double across2 = dot(across, across) + least * least;
        const double sine2 = k * (2.0 - k);
        const double sine_per_across = sine2 * inverse_root(sine2 * across2);
        const Vec3 wi = B * (1.0 - k) + across * sine_per_across;
        // Perpendicular but for 1e-16 / |across|, 1e-7 at worst: one step of Newton's for 1 / |wi|.
        return unit_already(wi * (1.5 - 0.5 * dot(wi, wi)));
    }
};

/// A triangle as a place sees it: what its samples and their density are made of.
struct TriangleView {
    double solid_angle = 0.0;  ///< that is drawn from [sr]; 0: nothing is to be seen
    bool by_area = false;      ///< too small for directions: drawn by its area
    Vec3 a, b, c;              ///< the corners from the place, or from just above it
    Vec3 normal;               ///< (b - a) x (c - a)
    double volume = 0.0;       ///< a . normal: six tetrahedra

    /// What its directions are made of; not by_area.
    SphericalTriangle spherical() const;
};
TriangleView view(const std::array<Point3, 3>& triangle, Point3 p);
LightSample sample(const TriangleView& view, Sample2 s);
LightSample look(const TriangleView& view, Dir3 wi);

/// Solid angle of a triangle seen from p [sr]; 0 in its plane.   Van Oosterom & Strackee 1983
double solid_angle(const std::array<Point3, 3>& triangle, Point3 p);

/// A direction toward a triangle, uniform in the solid angle that it subtends at p (as Arvo 1995,
/// by another way); uniform over its area, with the density turned into [1/sr], where that angle
/// is too small for its digits. L is left 0: what shines is the caller's matter. "no direction"
/// for a triangle that subtends nothing.   Test: TriangleSampling.*
LightSample sample_triangle(const std::array<Point3, 3>& triangle, Point3 p, Sample2 s);
/// The same seen along wi; "no direction" where it misses.
LightSample look_at_triangle(const std::array<Point3, 3>& triangle, Point3 p, Dir3 wi);

}  // namespace relight
