#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/vec.h"

/// Beckmann's distribution: a Gaussian of slopes.   Beckmann & Spizzichino 1963; Walter et al. 2007
namespace relight::beckmann {

/// D(m) = exp(-(mx^2/ax^2 + my^2/ay^2) / mz^2) / (pi ax ay mz^4) [1/sr]   Walter et al. 2007, eq.
/// 25 Test: D.IntegratesToOneOverTheProjectedHemisphere
inline double D(Vec3 m, double alpha_x, double alpha_y)
{
    if (m.z <= 0.0) { return 0.0; }
    const double px = m.x / m.z / alpha_x;
    const double py = m.y / m.z / alpha_y;
    const double gauss = std::exp(-(px * px + py * py));
    if (gauss == 0.0) { return 0.0; }  // near the horizon, where mz^4 vanishes too
    return gauss / (std::numbers::pi * alpha_x * alpha_y * (m.z * m.z) * (m.z * m.z));
}
inline double D(double cos_m, double alpha)
{
    return D(Vec3{std::sqrt(std::max(0.0, 1.0 - cos_m * cos_m)), 0.0, cos_m}, alpha, alpha);
}

/// Smith's Lambda times cos(w) (see smith.h). With t = sqrt(ax^2 wx^2 + ay^2 wy^2) and a = cos/t:
/// Lambda cos = t [exp(-a^2) / (2 sqrt pi) - a erfc(a) / 2]   Walter et al. 2007, sec. 5.3 (exact
/// form) Test: G1.ConservesTheProjectedArea
inline double Lambda_cos(Vec3 w, double alpha_x, double alpha_y)
{
    const double t = std::hypot(alpha_x * w.x, alpha_y * w.y);
    if (t == 0.0) { return 0.0; }
    const double a = w.z / t;
    const double tail = 0.5 * std::numbers::inv_sqrtpi * std::exp(-a * a) - 0.5 * a * std::erfc(a);
    return t * std::max(0.0, tail);
}

}  // namespace relight::beckmann
