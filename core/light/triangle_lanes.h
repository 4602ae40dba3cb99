#pragma once

#include <cmath>

#include "core/light/triangle.h"

/// TriangleView's numbers without a branch or a call, so that compilers vectorise what calls them.
namespace relight::lanes {

/// TriangleView::solid_angle of a, b, c.
inline double solid_angle(Vec3 a, Vec3 b, Vec3 c, double la, double lb, double lc, double volume)
{
    return 2.0 * warp::angle_above(std::abs(volume),
                                   la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

/// SphericalTriangle's, of unit A, B and C; no number where there is none.
inline SphericalTriangle spherical(Vec3 A, Vec3 B, Vec3 C, double angle)
{
    SphericalTriangle half;
    half.solid_angle = angle;
    half.A = A;
    half.B = B;
    const Vec3 chord = C - A;
    const Vec3 once = chord - A * dot(A, chord);
    const Vec3 twice = once - A * dot(A, once);
    half.T = twice * (1.0 / std::sqrt(dot(twice, twice)));
    const Vec3 both = A + B;
    half.sum = 0.5 * dot(both, both);
    half.sine = std::abs(dot(cross(A, B - A), half.T));
    half.b_dot_t = dot(B, half.T);
    return half;
}

}  // namespace relight::lanes
