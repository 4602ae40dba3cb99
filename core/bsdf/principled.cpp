#include "core/bsdf/principled.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/bsdf/fresnel.h"
#include "core/bsdf/ggx.h"
#include "core/bsdf/gtr.h"
#include "core/bsdf/mix.h"
#include "core/bsdf/smith.h"

namespace relight {
namespace {

constexpr Rgb white = Rgb::grey(1.0);

struct Parts {
    double D = 0.0, G2 = 0.0, V = 0.0;
    Rgb F;
    Rgb diffuse, sheen, specular, clearcoat;

    Rgb f() const { return diffuse + sheen + specular + clearcoat; }
};

/// S(u) = (1 - u)^5, how far F has gone from F0 to 1.
double S(double u)
{
    return fresnel::schlick(0.0, u);
}

/// The base's hue: its colour over its luminance (the model's own weights, not Rec. 709's).
Rgb tint_of(Rgb base)
{
    const double luminance = 0.3 * base.r + 0.6 * base.g + 0.1 * base.b;
    return luminance > 0.0 ? base / luminance : white;
}

/// The two diffuse shapes, with what they are mixed to and without the base colour [1/sr].
double diffuse_shape(const Principled& material, double cos_i, double cos_o, double cos_d)
{
    const double FL = S(cos_i), FV = S(cos_o);
    const double retro = material.roughness * cos_d * cos_d;
    const auto at_grazing = [&](double F90) { return mix(1.0, F90, FL) * mix(1.0, F90, FV); };
    const double Fd = at_grazing(0.5 + 2.0 * retro);

    // Hanrahan and Krueger's subsurface shape: 1 / (cos_i + cos_o) only nears infinity in the
    // plane.
    constexpr double least = 1e-100;
    const double Fss = at_grazing(retro);
    const double ss = 1.25 * (Fss * (1.0 / std::max(cos_i + cos_o, least) - 0.5) + 0.5);
    return mix(Fd, ss, material.subsurface) / std::numbers::pi;
}

/// GTR of exponent 1 under a GGX's masking, F0 = 0.04 (ior 1.5) [1/sr].
double clearcoat_shape(const Principled& material, Vec3 wi, Vec3 wo, Vec3 h, double FH)
{
    const double D = gtr::D(h.z, mix(0.1, 0.001, material.clearcoat_gloss), 1.0);
    constexpr double masking_alpha = 0.25;
    const double V = smith::V_separable(wi.z, ggx::Lambda_cos(wi, masking_alpha, masking_alpha),
                                        wo.z, ggx::Lambda_cos(wo, masking_alpha, masking_alpha));
    return mix(0.04, 1.0, FH) * D * V;
}

Parts parts(const Principled& material, Vec3 wi, Vec3 wo, Rgb vertex_color)
{
    if (!(wi.z > 0.0 && wo.z > 0.0)) { return {}; }
    const Rgb base = material.base_color_from_vertex ? vertex_color : material.base_color;
    const Rgb tint = tint_of(base);
    const Dir3 h = normalize(wi + wo);
    const double cos_d = dot(wi, h);
    const double FH = S(cos_d);
    const LobeWidths alpha = lobe_widths(material);
    const Rgb F0_dielectric = 0.08 * material.specular * mix(white, tint, material.specular_tint);

    Parts p;
    p.D = ggx::D(h, alpha.x, alpha.y);
    p.V = smith::V_separable(wi.z, ggx::Lambda_cos(wi, alpha.x, alpha.y), wo.z,
                             ggx::Lambda_cos(wo, alpha.x, alpha.y));
    p.G2 = 4.0 * wi.z * wo.z * p.V;
    p.F = mix(mix(F0_dielectric, base, material.metallic), white, FH);
    p.specular = p.F * (p.D * p.V);

    const double dielectric = 1.0 - material.metallic;
    p.diffuse = dielectric * diffuse_shape(material, wi.z, wo.z, cos_d) * base;
    p.sheen = dielectric * FH * material.sheen * mix(white, tint, material.sheen_tint);
    p.clearcoat = Rgb::grey(0.25 * material.clearcoat * clearcoat_shape(material, wi, wo, h, FH));
    return p;
}

}  // namespace

LobeWidths lobe_widths(const Principled& material)
{
    const double a = material.roughness * material.roughness;
    const double aspect = std::sqrt(1.0 - 0.9 * material.anisotropic);
    return {std::max(least_alpha, a / aspect), std::max(least_alpha, a * aspect)};
}

BsdfValue f(const Principled& material, Vec3 wi, Vec3 wo, Rgb vertex_color)
{
    return {parts(material, wi, wo, vertex_color).f()};
}

std::vector<BsdfTerm> terms(const Principled& material, Vec3 wi, Vec3 wo, Rgb vertex_color)
{
    const Parts p = parts(material, wi, wo, vertex_color);
    return {{"D", Rgb::grey(p.D)},
            {"G2", Rgb::grey(p.G2)},
            {"V", Rgb::grey(p.V)},
            {"F", p.F},
            {"diffuse", p.diffuse},
            {"sheen", p.sheen},
            {"specular", p.specular},
            {"clearcoat", p.clearcoat},
            {"f", p.f()}};
}

}  // namespace relight
