#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/sobol.h"
#include "core/base/vec.h"
#include "core/base/vectors.h"

/// Maps of the unit square that keep areas in proportion, each beside its density. Directions are
/// in the frame whose z is the axis.   Tests: Warp.*
namespace relight::warp {

struct SineCosine {
    double sine, cosine;
};
/// Of |x| <= pi / 4 [rad], within 2e-16, relatively for the sine. Taylor's series, whose next terms
/// are below that: sums and products alone, so that compilers vectorise what calls it.
constexpr SineCosine sine_cosine(double x)
{
    const double z = x * x;
    const double s =
        1.0 / 120 +
        z * (-1.0 / 5040 +
             z * (1.0 / 362880 +
                  z * (-1.0 / 39916800 + z * (1.0 / 6227020800 + z * (-1.0 / 1307674368000)))));
    const double c =
        1.0 / 24 +
        z * (-1.0 / 720 +
             z * (1.0 / 40320 +
                  z * (-1.0 / 3628800 + z * (1.0 / 479001600 + z * (-1.0 / 87178291200 +
                                                                    z * (1.0 / 20922789888000))))));
    return {x + x * (z * (-1.0 / 6 + z * s)), 1.0 + z * (-0.5 + z * c)};
}

/// Of `t` whole turns, |t| <= 2; within 4e-16.
constexpr SineCosine sine_cosine_of_turns(double t)
{
    const int quarters = static_cast<int>(4.0 * t + (t < 0.0 ? -0.5 : 0.5));
    const SineCosine rest = sine_cosine(2.0 * std::numbers::pi * (t - 0.25 * quarters));
    const bool odd = (quarters & 1) != 0, back = (quarters & 2) != 0;
    const double s = odd ? rest.cosine : rest.sine, c = odd ? -rest.sine : rest.cosine;
    return {back ? -s : s, back ? -c : c};
}

/// atan2(y, x) of y >= 0: the angle from 0 to pi, within 4e-16 of itself; 0 of two zeros. Without a
/// branch: the octant by comparisons, then a polynomial of |t| <= tan(pi / 8) (Chebyshev's
/// interpolation of (atan(t) / t - 1) / t^2 in t^2: 5e-18), so that compilers vectorise what calls
/// it. For finite x and y.   Test: Warp.AnglesAreThoseOfTheLibrary
constexpr double angle_above(double y, double x)
{
    constexpr double eighth = 0.41421356237309503;  // tan(pi / 8)
    const double wide = choose(where(x < 0.0), -x, x);
    const Mask is_steep = where(y > wide);
    const double least = choose(is_steep, wide, y), most = choose(is_steep, y, wide);
    const Mask is_turned = where(least > eighth * most);
    const double up = choose(is_turned, least - most, least);
    const double along = choose(is_turned, least + most, most);
    const double t = up / choose(where(along > 0.0), along, 1.0);
    const double z = t * t;
    const double low =
        -0.3333333333333333 +
        z * (0.1999999999999552 + z * (-0.14285714284666542 + z * 0.11111111015256361));
    const double high =
        -0.09090904578123903 +
        z * (0.07692183190826087 +
             z * (-0.06664511447381948 +
                  z * (0.0585814891280221 +
                       z * (-0.0508544973794026 +
                            z * (0.03923165829558719 + z * -0.019176887119062257)))));
    const double z2 = z * z;
    const double octant = t + t * (z * (low + z2 * z2 * high));
    const double acute = choose(is_turned, 0.25 * std::numbers::pi + octant, octant);
    const double quadrant = choose(is_steep, 0.5 * std::numbers::pi - acute, acute);
    return choose(where(x < 0.0), std::numbers::pi - quadrant, quadrant);
}

/// Uniform in the unit disk (z = 0).   Shirley & Chiu 1997 ("concentric map")
inline Vec3 disk(Sample2 s)
{
    const double a = 2.0 * s.u - 1.0;
    const double b = 2.0 * s.v - 1.0;
    const bool wide = std::abs(a) > std::abs(b);
    const double r = wide ? a : b, other = wide ? b : a;
    // The angle from the axis that is nearer; at the centre any.
    const SineCosine t = sine_cosine(0.25 * std::numbers::pi * (other / (r == 0.0 ? 1.0 : r)));
    return {r * (wide ? t.cosine : t.sine), r * (wide ? t.sine : t.cosine), 0.0};
}

/// Hemisphere with density cos / pi (Malley).
inline Vec3 cosine_hemisphere(Sample2 s)
{
    const Vec3 d = disk(s);
    return {d.x, d.y, std::sqrt(std::max(0.0, 1.0 - d.x * d.x - d.y * d.y))};
}
constexpr double cosine_hemisphere_pdf(double cos_theta)
{
    return std::max(0.0, cos_theta) * std::numbers::inv_pi;
}

/// Uniform within 1 - cos <= `height` of the axis: a cap of solid angle 2 pi height. `height` is
/// 1 - cos(half angle) = 2 sin^2(half / 2), given so that narrow cones keep their digits.
inline Vec3 cap(Sample2 s, double height)
{
    const Vec3 d = disk(s);
    const double h = (d.x * d.x + d.y * d.y) * height;  // 1 - cos
    const double widen = std::sqrt(height * std::max(0.0, 2.0 - h));
    return {d.x * widen, d.y * widen, 1.0 - h};
}
constexpr double cap_pdf(double height)
{
    return 0.5 * std::numbers::inv_pi / height;
}

/// Barycentric coordinates (of b and c) of a point uniform in a triangle.   Heitz 2019
inline Sample2 triangle(Sample2 s)
{
    if (s.v > s.u) { return {0.5 * s.u, s.v - 0.5 * s.u}; }
    return {s.u - 0.5 * s.v, 0.5 * s.v};
}

}  // namespace relight::warp
