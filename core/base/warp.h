#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/sobol.h"
#include "core/base/vec.h"

/// Maps of the unit square that keep areas in proportion, each beside its density. Directions are
/// in the frame whose z is the axis.   Tests: Warp.*
namespace relight::warp {

/// Uniform in the unit disk (z = 0).   Shirley & Chiu 1997 ("concentric map")
inline Vec3 disk(Sample2 s)
{
    const double a = 2.0 * s.u - 1.0;
    const double b = 2.0 * s.v - 1.0;
    if (a == 0.0 && b == 0.0) { return {}; }
    const bool wide = std::abs(a) > std::abs(b);
    const double r = wide ? a : b;
    const double phi = wide ? 0.25 * std::numbers::pi * (b / a)
                            : 0.5 * std::numbers::pi - 0.25 * std::numbers::pi * (a / b);
    return {r * std::cos(phi), r * std::sin(phi), 0.0};
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
    const double h = s.u * height;  // 1 - cos
    const double sine = std::sqrt(std::max(0.0, h * (2.0 - h)));
    const double phi = 2.0 * std::numbers::pi * s.v;
    return {sine * std::cos(phi), sine * std::sin(phi), 1.0 - h};
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
