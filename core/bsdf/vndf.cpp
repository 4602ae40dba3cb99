#include "core/bsdf/vndf.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/bsdf/ggx.h"

namespace relight::vndf {
namespace {

/// G1(wo) D(m) / cos_o, with G1 / cos_o = 1 / (cos_o + Lambda cos_o): finite at grazing.
double seen(Vec3 wo, Vec3 m, double alpha_x, double alpha_y)
{
    if (!(wo.z > 0.0)) { return 0.0; }
    return ggx::D(m, alpha_x, alpha_y) / (wo.z + ggx::Lambda_cos(wo, alpha_x, alpha_y));
}

}  // namespace

double D_visible(Vec3 wo, Vec3 m, double alpha_x, double alpha_y)
{
    return std::max(0.0, dot(wo, m)) * seen(wo, m, alpha_x, alpha_y);
}

Vec3 sample(Vec3 wo, double alpha_x, double alpha_y, Sample2 s)
{
    // Stretched by (alpha_x, alpha_y) the facets are those of a hemisphere, seen from v: uniform in
    // its projection, a half disk on one side of T1 and half an ellipse on the other.
    const Vec3 v = normalize({alpha_x * wo.x, alpha_y * wo.y, wo.z});
    const Dir3 across = normalize({-v.y, v.x, 0.0});
    const Vec3 T1 = across ? Vec3(across) : Vec3{1.0, 0.0, 0.0};
    const Vec3 T2 = cross(v, T1);
    const double r = std::sqrt(s.u);
    const double phi = 2.0 * std::numbers::pi * s.v;
    const double t1 = r * std::cos(phi);
    const double squeeze = 0.5 * (1.0 + v.z);
    const double rim = std::sqrt(std::max(0.0, 1.0 - t1 * t1));
    const double t2 = (1.0 - squeeze) * rim + squeeze * r * std::sin(phi);
    const double t3 = std::sqrt(std::max(0.0, 1.0 - t1 * t1 - t2 * t2));
    const Vec3 m = t1 * T1 + t2 * T2 + t3 * v;
    return normalize({alpha_x * m.x, alpha_y * m.y, std::max(0.0, m.z)});
}

double pdf_wi(Vec3 wo, Vec3 wi, double alpha_x, double alpha_y)
{
    // The wo.m of D_v and of the Jacobian 1 / (4 wo.m) cancel.
    return 0.25 * seen(wo, normalize(wi + wo), alpha_x, alpha_y);
}

}  // namespace relight::vndf
