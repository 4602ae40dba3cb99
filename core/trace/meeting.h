#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/vec.h"

namespace relight {

/// Where a line through the origin meets a triangle or a disc, in double: at t d, which for a
/// triangle is (1-u-v) a + u b + v c.
struct Meeting {
    double t{}, u{}, v{};
    bool inside{};  ///< false: it passes beside, and u and v are those of the nearest edge
};

/// Signed volumes of Pluecker coordinates (as Embree's robust test, here in double): neighbours
/// take the same number for an edge they share, so no line slips between them. Corners relative to
/// the line's origin. None: the line lies in the plane, or the triangle has no area.
inline std::optional<Meeting> meet_triangle(Vec3 d, Vec3 a, Vec3 b, Vec3 c)
{
    const auto volume = [d](Vec3 p, Vec3 q) { return dot(cross(q - p, q + p), d); };
    const double wa = volume(b, c), wb = volume(c, a), wc = volume(a, b);
    const double sum = wa + wb + wc;
    const Vec3 normal = cross(b - a, c - a);
    const double t = dot(a, normal) / dot(d, normal);
    if (sum == 0.0 || !is_finite(t)) { return std::nullopt; }
    const double u = std::clamp(wb / sum, 0.0, 1.0);
    const double v = std::clamp(wc / sum, 0.0, 1.0 - u);
    // A line through an edge belongs to both sides of it, whatever the last bits say.
    const double slack = 1e-12 * (std::abs(wa) + std::abs(wb) + std::abs(wc));
    const auto [least, most] = std::minmax({wa, wb, wc});
    if (least >= -slack || most <= slack) { return Meeting{t, u, v, true}; }
    return Meeting{dot(a * (1.0 - u - v) + b * u + c * v, d), u, v, false};
}

/// Centre relative to the line's origin. None: the line lies in the plane.
inline std::optional<Meeting> meet_disc(Vec3 d, Vec3 centre, Dir3 normal, double radius)
{
    const double t = dot(centre, normal) / dot(d, normal);
    if (!is_finite(t)) { return std::nullopt; }
    return Meeting{t, 0.0, 0.0, length(d * t - centre) <= radius};
}

}  // namespace relight
