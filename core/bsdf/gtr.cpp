#include "core/bsdf/gtr.h"

#include <algorithm>

namespace relight::gtr {
namespace {

/// Lambda cos / sin^2 of a direction at cosine c and sine s.
///
/// The hidden area is the projected area of the facets that face w without being needed to cover
/// cos(w): in slopes (rho along the circle of equal facing, after the azimuth is integrated out)
///   Lambda cos = 2 sin int (rho - mu atan(rho / mu)) P22(sqrt(mu^2 + rho^2)) rho drho,  mu =
///   cot(w).
/// For GTR, P22(r) = D cos^4 = D_peak (1 + r^2)^(gamma - 2) (1 + r^2/a^2)^-gamma. Put rho = v /
/// sin:
///   Lambda cos / sin^2 = 2 D_peak int (v - c atan(v/c)) v (1 + v^2)^(gamma - 2) u^-gamma dv,
///   u = sin^2 + (c^2 + v^2) / a^2,
/// which is regular at both ends of c. In ln v the integrand dies away exponentially on both sides
/// and is analytic between, so equal steps converge faster than any power of the step.
double hidden_ratio(double c, double s, double alpha, double gamma)
{
    constexpr double h = 0.2;         // [ln v]
    constexpr double highest = 23.0;  // the integrand falls as 1/v: 1e-10 of it lies beyond
    const double lowest = std::log(alpha) - 9.0;  // and rises as v^3 or faster: 1e-11 below
    double sum = 0.0;
    for (int i = 0; lowest + i * h < highest; ++i) {
        const double v = std::exp(lowest + i * h);
        const double u = s * s + (c * c + v * v) / (alpha * alpha);
        const double facing = (v - c * std::atan2(v, c)) * v;
        sum += facing * std::exp((gamma - 2.0) * std::log1p(v * v) - gamma * std::log(u)) * v;
    }
    return 2.0 * D_peak(alpha, gamma) * h * sum;
}

}  // namespace

Masking::Masking(double alpha, double gamma)
    : alpha_(alpha), step_(std::asinh(1.0 / alpha) / (nodes - 1))
{
    // asinh spends the nodes where the curve bends: at cosines about alpha.
    for (int i = 0; i < nodes; ++i) {
        const double c = std::min(1.0, alpha * std::sinh(i * step_));
        const double s = std::sqrt((1.0 - c) * (1.0 + c));
        log_ratio_[static_cast<std::size_t>(i)] = std::log(hidden_ratio(c, s, alpha, gamma));
    }
}

double Masking::Lambda_cos(Vec3 w) const
{
    const double x = std::asinh(std::clamp(w.z, 0.0, 1.0) / alpha_) / step_;
    const int first = std::clamp(static_cast<int>(x) - 1, 0, nodes - 4);
    const double t = x - first;  // Lagrange's cubic through the nodes 0, 1, 2, 3
    const double* y = log_ratio_.data() + first;
    const double ln =
        -y[0] * (t - 1.0) * (t - 2.0) * (t - 3.0) / 6.0 + y[1] * t * (t - 2.0) * (t - 3.0) / 2.0 -
        y[2] * t * (t - 1.0) * (t - 3.0) / 2.0 + y[3] * t * (t - 1.0) * (t - 2.0) / 6.0;
    return std::exp(ln) * (w.x * w.x + w.y * w.y);
}

}  // namespace relight::gtr
