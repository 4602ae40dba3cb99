#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/vec.h"

/// Integrals that know nothing of the formulas they check.
namespace relight::quadrature {

/// Gauss-Legendre of 5 points on [-1, 1]; the weights add up to 2.
struct Node {
    double x, weight;
};
inline constexpr Node gauss[] = {{-0.9061798459386640, 0.2369268850561891},
                                 {-0.5384693101056831, 0.4786286704993665},
                                 {0.0, 0.5688888888888889},
                                 {0.5384693101056831, 0.4786286704993665},
                                 {0.9061798459386640, 0.2369268850561891}};

/// int g(x) dx over [a, b]: that rule on each of `panels` equal parts.
template <class G>
double over_interval(G g, double a, double b, int panels)
{
    const double half = 0.5 * (b - a) / panels;
    double sum = 0.0;
    for (int i = 0; i < panels; ++i) {
        const double middle = a + half * (2.0 * i + 1.0);
        for (const Node& node : gauss) { sum += node.weight * g(middle + half * node.x); }
    }
    return sum * half;
}

/// int g(r) dr over (0, infinity) by the trapezoid rule in ln r, for g that vanish at both ends;
/// `scale` is about where they are largest. Lobes are as narrow as 1e-3 and have long tails.
template <class G>
double over_positive(G g, double scale, double step = 0.01)
{
    const double lowest = std::log(scale) - 14.0;
    const int steps = static_cast<int>(32.0 / step);
    double sum = 0.0;
    for (int i = 0; i <= steps; ++i) {
        const double r = std::exp(lowest + i * step);
        sum += g(r) * r;
    }
    return sum * step;
}

/// int max(0, a + b cos(phi)) dphi over a turn.
inline double positive_turn(double a, double b)
{
    b = std::abs(b);
    if (a >= b) { return 2.0 * std::numbers::pi * a; }
    if (a <= -b) { return 0.0; }
    const double edge = std::acos(-a / b);
    return 2.0 * (a * edge + b * std::sin(edge));
}

/// A unit direction from its cosine to z and its azimuth.
inline Vec3 direction(double cosine, double azimuth)
{
    const double s = std::sqrt((1.0 - cosine) * (1.0 + cosine));
    return {s * std::cos(azimuth), s * std::sin(azimuth), cosine};
}

/// int g(w) dw over the directions whose cosine to z is between `from` and `to`.
template <class G>
double over_zone(G g, double from, double to, int panels, int turns)
{
    const auto ring = [&](double cosine) {
        double sum = 0.0;
        for (int j = 0; j < turns; ++j) {
            sum += g(direction(cosine, 2.0 * std::numbers::pi * (j + 0.5) / turns));
        }
        return sum * 2.0 * std::numbers::pi / turns;
    };
    return over_interval(ring, from, to, panels);
}

}  // namespace relight::quadrature
