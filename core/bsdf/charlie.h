#pragma once

#include <array>

#include "core/base/vec.h"

/// Sheen: a forest of fibres that stand about the normal and shine across it. alpha = roughness^2,
/// least_alpha..1.   Conty Estevez & Kulla 2017, as KHR_materials_sheen writes it
namespace relight::charlie {

/// D(m) = (2 + 1/a) sin^(1/a)(theta_m) / (2 pi) [1/sr]; m unit.
/// Test: Charlie.DistributionIntegratesToOneOverTheProjectedHemisphere
double D(Vec3 m, double alpha);

/// Smith's Lambda, a fit of the integral of D.   Test: Charlie.LambdaIsNearTheIntegralOfD
double Lambda(double cos_w, double alpha);
/// Of that fit, a, b, c, d, e of l(x) = a / (1 + b x^c) + d x + e: Lambda = exp(l(cos)) below 60
/// degrees, exp(2 l(1/2) - l(1 - cos)) above.
std::array<double, 5> Lambda_fit(double alpha);

/// V = 1 / ((1 + Lambda_i + Lambda_o) 4 cos_i cos_o).
double V(double cos_i, double cos_o, double alpha);

/// Share of a uniform sky that D V reflects toward wo, at most 1: the fit is too bright for narrow
/// fibres at grazing (up to 6 where alpha = least_alpha), and what lies below can't lose more than
/// all of its light. Read from a table that the first call integrates (some 0.1 s), within 2e-3.
/// Test: Charlie.AlbedoTableIsTheIntegralOfTheLobe
double E(double cos_o, double alpha);
/// Of that table, E before it is cut off at 1, at cos = (i / (columns - 1))^3; linear between.
inline constexpr int albedo_columns = 128;
std::array<double, albedo_columns> E_over_cosines(double alpha);

}  // namespace relight::charlie
