#pragma once

#include <algorithm>

/// Smith's masking and shadowing: heights and slopes of the facets are independent.   Smith 1967
///
/// Facets that face w have projected area cos(w) (1 + Lambda(w)) per unit of surface; only cos(w)
/// of it can be seen. So G1 = 1 / (1 + Lambda) is the visible share, and `Lambda_cos` = Lambda(w)
/// cos(w) is the hidden area itself. Distributions give that product: it stays finite and positive
/// at grazing, where Lambda does not, and no tangent is needed.
namespace relight::smith {

/// G1(w) = cos / (cos + Lambda cos); 0 from below.   Heitz 2014, eq. 43
/// Test: G1.ConservesTheProjectedArea
constexpr double G1(double cos_w, double Lambda_cos)
{
    return cos_w > 0.0 ? cos_w / (cos_w + Lambda_cos) : 0.0;
}

/// V = G2 / (4 cos_i cos_o), G2 = 1 / (1 + Lambda_i + Lambda_o): a facet high enough to be seen is
/// also more likely lit.   Heitz 2014, eq. 99   Test: G2.CorrelatedIsNeverLessThanSeparable
constexpr double V_height_correlated(double cos_i, double Lambda_cos_i, double cos_o,
                                     double Lambda_cos_o)
{
    constexpr double least = 1e-100;  // both directions in the plane: large, but still a number
    const double area = cos_i * cos_o + Lambda_cos_i * cos_o + Lambda_cos_o * cos_i;
    return 0.25 / std::max(area, least);
}

/// V = G2 / (4 cos_i cos_o), G2 = G1(wi) G1(wo): lit and seen independently (Disney 2012).
constexpr double V_separable(double cos_i, double Lambda_cos_i, double cos_o, double Lambda_cos_o)
{
    constexpr double least = 1e-100;
    return 0.25 / std::max((cos_i + Lambda_cos_i) * (cos_o + Lambda_cos_o), least);
}

}  // namespace relight::smith
