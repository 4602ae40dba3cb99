#include "core/bsdf/oren_nayar.h"

#include <algorithm>
#include <numbers>

namespace relight {
namespace {

struct Parts {
    double A = 0.0, B = 0.0, lean = 0.0;
    Rgb f;
};

Parts parts(const OrenNayar& material, Vec3 wi, Vec3 wo, Rgb vertex_color)
{
    if (!(wi.z > 0.0 && wo.z > 0.0)) { return {}; }
    const double s2 = material.sigma * material.sigma;
    const Rgb rho = material.albedo_from_vertex ? vertex_color : material.albedo;
    Parts p;
    p.A = 1.0 - 0.5 * s2 / (s2 + 0.33);
    p.B = 0.45 * s2 / (s2 + 0.09);
    // sin(alpha) tan(beta) = sin_i sin_o / max(cos_i, cos_o), and sin_i sin_o cos(dphi) is the dot
    // product of what lies in the plane: no angle, no azimuth of a direction along the normal.
    constexpr double least = 1e-100;  // both directions in the plane: large, but still a number
    const double along = wi.x * wo.x + wi.y * wo.y;
    p.lean = std::max(0.0, along) / std::max({wi.z, wo.z, least});
    p.f = rho / std::numbers::pi * (p.A + p.B * p.lean);
    return p;
}

}  // namespace

BsdfValue f(const OrenNayar& material, Vec3 wi, Vec3 wo, Rgb vertex_color)
{
    return {parts(material, wi, wo, vertex_color).f};
}

std::vector<BsdfTerm> terms(const OrenNayar& material, Vec3 wi, Vec3 wo, Rgb vertex_color)
{
    const Parts p = parts(material, wi, wo, vertex_color);
    return {{"A", Rgb::grey(p.A)},
            {"B", Rgb::grey(p.B)},
            {"lean", Rgb::grey(p.lean)},
            {"diffuse", p.f},
            {"f", p.f}};
}

}  // namespace relight
