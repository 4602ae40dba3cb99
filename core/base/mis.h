#pragma once

#include <cmath>

/// Weights of a sample that several samplers could have drawn, so that its estimates add up to one:
/// sum over samplers k of w_k = 1 wherever any density is positive. n samples are drawn with
/// density p each; all densities in the same measure.   Veach & Guibas 1995   Tests: Mis.*
namespace relight::mis {

/// a / (a + b) for a, b >= 0, infinite ones (a delta) and overflow included; 0 for a = 0: such a
/// sample is never drawn.
inline double share(double a, double b, int power)
{
    if (!(a > 0.0)) { return 0.0; }
    if (a == b) { return 0.5; }
    return 1.0 / (1.0 + std::pow(b / a, power));
}

/// w_1 = n_1 p_1 / (n_1 p_1 + n_2 p_2)
inline double balance(double n1, double p1, double n2, double p2)
{
    return share(n1 * p1, n2 * p2, 1);
}

/// w_1 = (n_1 p_1)^2 / ((n_1 p_1)^2 + (n_2 p_2)^2): less noise where one sampler is much the
/// better.
inline double power2(double n1, double p1, double n2, double p2)
{
    return share(n1 * p1, n2 * p2, 2);
}

}  // namespace relight::mis
