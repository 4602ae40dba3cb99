#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/vec.h"

/// Integrals over directions that know nothing of the formulas they check. Slopes run from 0 to
/// infinity and lobes are as narrow as alpha = 1e-3, so radii go in equal steps of their logarithm:
/// for smooth integrands that vanish at both ends the error falls exponentially with the step.
namespace relight::test {

/// Integral of g(r) dr over (0, infinity): trapezoid in ln r, r from e^lowest to e^highest.
template <class G>
double over_positive(G g, double lowest, double highest, double step)
{
    double sum = 0.0;
    for (int i = 0; lowest + i * step <= highest; ++i) {
        const double r = std::exp(lowest + i * step);
        sum += g(r) * r;
    }
    return sum * step;
}

/// Unit facet normal of slopes (p, q): m is proportional to (p, q, 1).
inline Vec3 facet(double p, double q)
{
    return Vec3{p, q, 1.0} / std::sqrt(1.0 + p * p + q * q);
}

/// Integral of g(m) dm over the upper hemisphere in polar slopes; `scale` is about the lobe's
/// width. dm = m_z^3 r dr dphi with r = tan(theta).
template <class G>
double over_facets(G g, double scale, int turns = 64, double step = 0.1)
{
    const auto ring = [&](double r) {
        double sum = 0.0;
        for (int j = 0; j < turns; ++j) {
            const double phi = 2.0 * std::numbers::pi * (j + 0.5) / turns;
            const Vec3 m = facet(r * std::cos(phi), r * std::sin(phi));
            sum += g(m) * m.z * m.z * m.z;
        }
        return sum * r * 2.0 * std::numbers::pi / turns;
    };
    return over_positive(ring, std::log(scale) - 14.0, std::max(0.0, std::log(scale)) + 18.0, step);
}

/// Integral of g(x) dx over [a, b]: Gauss-Legendre of 5 points on each of `panels` equal parts.
template <class G>
auto over_interval(G g, double a, double b, int panels)
{
    constexpr double x[] = {0.0, 0.5384693101056831, 0.9061798459386640};
    constexpr double w[] = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
    const double half = 0.5 * (b - a) / panels;
    decltype(g(a)) sum{};  // of numbers or of colours
    for (int i = 0; i < panels; ++i) {
        const double mid = a + half * (2 * i + 1);
        sum += w[0] * g(mid);
        for (int k = 1; k < 3; ++k) { sum += w[k] * (g(mid - half * x[k]) + g(mid + half * x[k])); }
    }
    return sum * half;
}

/// The area of facets facing w that masking must hide, per unit surface: Lambda(w) cos(w). Smith's
/// identity in Cartesian slopes with p along w: sin(w) int_mu^inf (p - mu) int P22(p, q) dq dp,
/// P22 = D m_z^4, mu = cot(w).
template <class D>
double hidden_area(D distribution, Vec3 w, double scale)
{
    const double s = std::hypot(w.x, w.y);
    const Vec3 along{w.x / s, w.y / s, 0.0};
    const double mu = w.z / s;
    const auto P22 = [&](double p, double q) {
        const double mz2 = 1.0 / (1.0 + p * p + q * q);
        return distribution(facet(along.x * p - along.y * q, along.y * p + along.x * q)) * mz2 *
               mz2;
    };
    const double lowest = std::log(scale) - 20.0, step = 0.14;
    const double highest = std::max(0.0, std::log(scale + mu)) + 18.0;
    return s * over_positive(
                   [&](double beyond) {
                       const double p = mu + beyond;
                       const auto both = [&](double q) { return P22(p, q) + P22(p, -q); };
                       return beyond * over_positive(both, lowest, highest, step);
                   },
                   lowest, highest, step);
}

/// A unit direction from its cosine to z and its azimuth.
inline Vec3 direction(double cosine, double azimuth)
{
    const double s = std::sqrt((1.0 - cosine) * (1.0 + cosine));
    return {s * std::cos(azimuth), s * std::sin(azimuth), cosine};
}

}  // namespace relight::test
