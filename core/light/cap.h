#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/vec.h"

namespace relight {

/// z - atan(z) of a small z >= 0, where the difference would lose the digits.
inline double z_minus_atan(double z)
{
    if (z > 0.03) { return z - std::atan(z); }
    const double z2 = z * z;  // the next term is 1e-17 of the first
    return z * z2 * (1.0 / 3 - z2 * (1.0 / 5 - z2 * (1.0 / 7 - z2 * (1.0 / 9 - z2 / 11))));
}

/// E at n of a uniform cap of directions around `axis` of radiance 1, whose half angle (at most
/// pi / 2) has the sine s, cos_beta = n . axis: the sphere's and the sun's formula. Wholly above
/// the horizon pi s^2 cos_beta, wholly below it 0; else with x = sqrt(1/s^2 - 1),
/// y = -x cos_beta / sin_beta, t = sin_beta sqrt(1 - y^2):
///   E = s^2 (cos_beta acos(y) - x t) + atan(t / x).   Contract section 2. Test: Cap.*
inline double cap_irradiance(double s, double cos_beta)
{
    const double s2 = s * s;
    if (cos_beta >= s) { return std::numbers::pi * s2 * cos_beta; }
    if (cos_beta <= -s) { return 0.0; }
    const double x = std::sqrt((1.0 - s) * (1.0 + s)) / s;
    const double sin_beta = std::sqrt((1.0 - cos_beta) * (1.0 + cos_beta));
    const double y = std::clamp(-x * cos_beta / sin_beta, -1.0, 1.0);
    const double root = std::sqrt((1.0 - y) * (1.0 + y));
    const double t = sin_beta * root;
    const double acos_y = std::atan2(root, y);  // with the rounding of t: they must cancel
    // s^2 x^2 = 1 - s^2: of a narrow cap the last two terms are equal but for s^3, so that is what
    // is computed.
    const double E = t < x ? s2 * (cos_beta * acos_y + t / x) - z_minus_atan(t / x)
                           : s2 * (cos_beta * acos_y - x * t) + std::atan2(t, x);
    return std::max(0.0, E);
}

}  // namespace relight
