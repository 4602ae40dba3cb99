#pragma once

#include <algorithm>
#include <cmath>
#include <complex>

/// Share of the light that a smooth facet reflects, unpolarised. `u` is wi.h = wo.h, the cosine at
/// the facet, not at the surface; outside [0, 1] it is clamped.   Tests: Fresnel.*
namespace relight::fresnel {

/// F = F0 + (F90 - F0) (1 - u)^5   Schlick 1994
inline double schlick(double F0, double u, double F90 = 1.0)
{
    const double w = 1.0 - std::clamp(u, 0.0, 1.0);
    return F0 + (F90 - F0) * (w * w) * (w * w) * w;
}

/// F_avg = 2 int F u du = F0 + (F90 - F0) / 21 over [0, 1].
constexpr double schlick_mean(double F0, double F90 = 1.0)
{
    return F0 + (F90 - F0) / 21.0;
}

/// F = (|r_s|^2 + |r_p|^2) / 2 for a boundary whose relative index n + ik squares to N2.
/// With g = sqrt(N2 - sin^2) = N cos(theta_t): r_s = (u - g) / (u + g), r_p = (N2 u - g) / (N2 u +
/// g), which needs no refracted angle and holds beyond the critical angle. Where both terms vanish
/// (grazing) or overflow (a perfect mirror) the limit is 1.
template <class Number>
double reflectance(Number N2, Number g, double u)
{
    const auto share = [](Number kept, Number all) {
        const double r2 = std::norm(kept) / std::norm(all);
        return r2 < 1.0 ? r2 : 1.0;
    };
    return 0.5 * (share(u - g, u + g) + share(N2 * u - g, N2 * u + g));
}

/// Fresnel equations of a dielectric, eta = eta_t / eta_i; 1 beyond the critical angle.
inline double dielectric(double eta, double u)
{
    const double c = std::clamp(u, 0.0, 1.0);
    const double g2 = (eta - 1.0) * (eta + 1.0) + c * c;  // eta^2 - sin^2, little cancelled
    return g2 > 0.0 ? reflectance(eta * eta, std::sqrt(g2), c) : 1.0;
}

/// Fresnel equations of a conductor of index n + ik relative to the outside.
inline double conductor(double n, double k, double u)
{
    const double c = std::clamp(u, 0.0, 1.0);
    const std::complex<double> N2{(n - k) * (n + k), 2.0 * n * k};
    const std::complex<double> g2{(n - 1.0) * (n + 1.0) + c * c - k * k, 2.0 * n * k};
    return reflectance(N2, std::sqrt(g2), c);
}

}  // namespace relight::fresnel
