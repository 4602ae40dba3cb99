#pragma once

#include "core/base/sobol.h"
#include "core/base/vec.h"

/// GGX normals as they are seen from wo: D_v(m) = G1(wo) (wo.m)+ D(m) / cos_o.   Heitz 2018
namespace relight::vndf {

/// Density D_v of a facet normal m [1/sr].
double D_visible(Vec3 wo, Vec3 m, double alpha_x, double alpha_y);

/// A visible normal (Heitz 2018, exact); wo.z > 0.   Test: Vndf.*
Vec3 sample(Vec3 wo, double alpha_x, double alpha_y, Sample2 s);

/// Density of wi = reflect(wo, m): D_v / (4 wo.m) [1/sr].
double pdf_wi(Vec3 wo, Vec3 wi, double alpha_x, double alpha_y);

}  // namespace relight::vndf
