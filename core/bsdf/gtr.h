#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "core/base/sobol.h"
#include "core/base/vec.h"

/// Generalised Trowbridge-Reitz: (1 + (a^2 - 1) cos^2)^-gamma, normalised.   Burley 2012, app. B
/// gamma = 1 is Disney's clear coat (GTR1), 2 is GGX; less gives longer tails.
namespace relight::gtr {

/// D at the pole [1/sr]. With ln a^2 = L and s = (gamma - 1) (-L):
/// (gamma - 1)(a^2 - 1) / (pi (1 - a^(2 - 2 gamma))) a^(-2 gamma) = (a^2 - 1)/(L a^2) s/(1 - e^-s)
/// / pi. Both quotients are 1 at 0: no special case at gamma = 1 or alpha = 1, and no overflow.
inline double D_peak(double alpha, double gamma)
{
    const double a2 = alpha * alpha;
    const double x = (alpha - 1.0) * (alpha + 1.0);
    const double L = std::log1p(x);
    const double s = (1.0 - gamma) * L;
    const double spread = L == 0.0 ? 1.0 : x / L;
    const double tail = s == 0.0 ? 1.0 : s / -std::expm1(-s);
    return spread * tail / (std::numbers::pi * a2);
}

/// D(m) = D_peak u^-gamma [1/sr], u = cos^2 + sin^2 / a^2 (the bracket over its value at the pole,
/// so between 1 and a^-2).   0 < alpha <= 1, gamma > 0. Test:
/// D.IntegratesToOneOverTheProjectedHemisphere, Gtr.*
inline double D(double cos_m, double alpha, double gamma)
{
    if (cos_m <= 0.0) { return 0.0; }
    const double c2 = cos_m * cos_m;
    const double u = c2 + (1.0 - c2) / (alpha * alpha);
    return D_peak(alpha, gamma) * std::pow(u, -gamma);
}

/// A facet normal with density D cos_m [1/sr]: where facets are, seen from above.   Burley 2012,
/// app. B, for any gamma. Test: Gtr.NormalsAreDrawnFromTheirDistribution
Vec3 sample(double alpha, double gamma, Sample2 s);

/// Smith's Lambda times cos(w) of one GTR lobe, from D by the conservation of projected area. It
/// has no closed form for most gamma, so it is integrated once over a grid of angles and read off
/// by a cubic: within 1e-7 of the integral in G1. Immutable, 4 KiB, about 5 ms to make.
class Masking {
  public:
    Masking(double alpha, double gamma);

    /// See smith.h; w unit, w.z > 0.   Test: Gtr.MaskingIsTheIntegralOfItsDistribution
    double Lambda_cos(Vec3 w) const;

    static constexpr int nodes = 512;
    /// The table itself: ln(Lambda cos / sin^2) at asinh(cos / alpha) = i step().
    const std::array<double, nodes>& log_ratios() const { return log_ratio_; }
    double step() const { return step_; }

  private:
    double alpha_, step_;
    std::array<double, nodes> log_ratio_{};
};

}  // namespace relight::gtr
