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

Vec3 sample(double alpha, double gamma, Sample2 s)
{
    // D cos dm = pi D d(sin^2) with D as t^-gamma, t = sin^2 + a^2 cos^2 from a^2 (the pole) to 1:
    // with g = 1 - gamma and L = ln a^2, t^g runs from a^(2 g) to 1 in equal steps of s.u. From the
    // pole, in logarithms:   ln(t / a^2) = ln(1 + s.u (a^(-2 g) - 1)) / g, which is -L s.u at g =
    // 0.
    const double x = (alpha - 1.0) * (alpha + 1.0);
    const double L = std::log1p(x);
    const double g = 1.0 - gamma;
    const double above = g == 0.0 ? -L * s.u : std::log1p(s.u * std::expm1(-g * L)) / g;
    const double sin2 = x == 0.0 ? s.u : alpha * alpha * std::expm1(above) / -x;
    const double sine = std::sqrt(std::clamp(sin2, 0.0, 1.0));
    const double phi = 2.0 * std::numbers::pi * s.v;
    return {sine * std::cos(phi), sine * std::sin(phi), std::sqrt((1.0 - sine) * (1.0 + sine))};
}

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
