#pragma once

#include <cmath>
#include <numbers>

#include "core/base/vec.h"

/// GGX, also called Trowbridge-Reitz and GTR of exponent 2.   Walter et al. 2007
namespace relight::ggx {

/// D(m) = a^2 / (pi cos^4(theta_m) (a^2 + tan^2(theta_m))^2) [1/sr]   Walter et al. 2007, eq. 33
/// Test: D.IntegratesToOneOverTheProjectedHemisphere
inline double D(double cos_m, double alpha)
{
    if (cos_m <= 0.0) { return 0.0; }
    const double a2 = alpha * alpha;
    const double c2 = cos_m * cos_m;
    const double t = (1.0 - c2) + a2 * c2;  // cos^4 multiplied in: no tan, finite at grazing
    return a2 / (std::numbers::pi * t * t);
}

/// D(m) = 1 / (pi ax ay ((mx/ax)^2 + (my/ay)^2 + mz^2)^2) [1/sr]   Burley 2012, eq. 13
/// Test: D.WithEqualWidthsIsTheIsotropicOne
inline double D(Vec3 m, double alpha_x, double alpha_y)
{
    if (m.z <= 0.0) { return 0.0; }
    const double px = m.x / alpha_x;
    const double py = m.y / alpha_y;
    const double t = px * px + py * py + m.z * m.z;
    return 1.0 / (std::numbers::pi * alpha_x * alpha_y * t * t);
}

/// Smith's Lambda times cos(w) (see smith.h): (sqrt(cos^2 + t2) - cos) / 2 with
/// t2 = ax^2 wx^2 + ay^2 wy^2, turned so that nothing cancels.   Walter et al. 2007, eq. 34
/// Test: G1.ConservesTheProjectedArea
inline double Lambda_cos(Vec3 w, double alpha_x, double alpha_y)
{
    const double tx = alpha_x * w.x;
    const double ty = alpha_y * w.y;
    const double t2 = tx * tx + ty * ty;
    if (t2 == 0.0) { return 0.0; }
    return 0.5 * t2 / (std::sqrt(w.z * w.z + t2) + w.z);
}

}  // namespace relight::ggx
