#include "core/bsdf/metallic_roughness.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/bsdf/charlie.h"
#include "core/bsdf/fresnel.h"
#include "core/bsdf/ggx.h"
#include "core/bsdf/mix.h"
#include "core/bsdf/smith.h"

namespace relight {
namespace {

struct Parts {
    double D = 0.0, G2 = 0.0, V = 0.0;
    Rgb F;
    Rgb diffuse, specular, sheen, clearcoat;

    Rgb f() const { return diffuse + specular + sheen + clearcoat; }
};

double strongest(Rgb c)
{
    return std::max({c.r, c.g, c.b});
}

Rgb schlick(Rgb F0, double u, double F90)
{
    return {fresnel::schlick(F0.r, u, F90), fresnel::schlick(F0.g, u, F90),
            fresnel::schlick(F0.b, u, F90)};
}

/// F of the dielectric at the facet; ior = 0 gives F0 = 1 as an infinite one does.
Rgb dielectric(const MetallicRoughness& material, double u)
{
    const double r = (material.ior - 1.0) / (material.ior + 1.0);
    const auto F0 = [&](double color) { return std::min(r * r * color, 1.0) * material.specular; };
    const Rgb c = material.specular_color;
    return schlick({F0(c.r), F0(c.g), F0(c.b)}, u, material.specular);
}

/// w in the frame whose x is the tangent turned by `rotation`, counter-clockwise about the normal.
Vec3 turned(Vec3 w, double rotation)
{
    const double c = std::cos(rotation), s = std::sin(rotation);
    return {c * w.x + s * w.y, c * w.y - s * w.x, w.z};
}

struct Lobe {
    double D, V;
};
/// GGX with height-correlated masking; all directions in the lobe's own frame.
Lobe lobe(LobeWidths alpha, Vec3 wi, Vec3 wo, Vec3 h)
{
    return {ggx::D(h, alpha.x, alpha.y),
            smith::V_height_correlated(wi.z, ggx::Lambda_cos(wi, alpha.x, alpha.y), wo.z,
                                       ggx::Lambda_cos(wo, alpha.x, alpha.y))};
}

/// What the sheen leaves to the layers below it.
double under_sheen(const MetallicRoughness& material, double alpha, double cos_i, double cos_o)
{
    const double c = strongest(material.sheen_color);
    return 1.0 - c * std::max(charlie::E(cos_i, alpha), charlie::E(cos_o, alpha));
}

/// What the clear coat takes from the layers below it.
double coat_share(const MetallicRoughness& material, double cos_o)
{
    return material.clearcoat * fresnel::schlick(0.04, cos_o);
}

Parts parts(const MetallicRoughness& material, Vec3 wi, Vec3 wo, Rgb vertex_color)
{
    if (!(wi.z > 0.0 && wo.z > 0.0)) { return {}; }
    const Rgb base = material.base_color_from_vertex ? vertex_color : material.base_color;
    const Dir3 h = normalize(wi + wo);
    const double u = dot(wi, h);
    const double coat = coat_share(material, wo.z);
    double uncovered = 1.0 - coat;

    Parts p;
    if (coat > 0.0) {
        const double alpha = alpha_from_roughness(material.clearcoat_roughness);
        const Lobe over = lobe({alpha, alpha}, wi, wo, h);
        p.clearcoat = Rgb::grey(coat * over.D * over.V);
    }
    if (strongest(material.sheen_color) > 0.0) {
        const double alpha = alpha_from_roughness(material.sheen_roughness);
        p.sheen = material.sheen_color *
                  (uncovered * charlie::D(h, alpha) * charlie::V(wi.z, wo.z, alpha));
        uncovered *= under_sheen(material, alpha, wi.z, wo.z);
    }

    const double angle = material.anisotropy_rotation;
    const Lobe facets =
        lobe(lobe_widths(material), turned(wi, angle), turned(wo, angle), turned(h, angle));
    const Rgb F_d = dielectric(material, u);
    const Rgb F_m = schlick(base, u, 1.0);
    p.D = facets.D;
    p.V = facets.V;
    p.G2 = 4.0 * wi.z * wo.z * p.V;
    p.F = mix(F_d, F_m, material.metallic);
    p.specular = p.F * (uncovered * p.D * p.V);
    const double kept = (1.0 - material.metallic) * std::max(0.0, 1.0 - strongest(F_d));
    p.diffuse = base / std::numbers::pi * (uncovered * kept);
    return p;
}

}  // namespace

LobeWidths lobe_widths(const MetallicRoughness& material)
{
    const double alpha = alpha_from_roughness(material.roughness);
    const double strength = material.anisotropy_strength;
    return {mix(alpha, 1.0, strength * strength), alpha};
}

BsdfValue f(const MetallicRoughness& material, Vec3 wi, Vec3 wo, Rgb vertex_color)
{
    return {parts(material, wi, wo, vertex_color).f()};
}

Rgb emission(const MetallicRoughness& material, double cos_o)
{
    return material.emissive * (material.emissive_strength * (1.0 - coat_share(material, cos_o)));
}

std::vector<BsdfTerm> terms(const MetallicRoughness& material, Vec3 wi, Vec3 wo, Rgb vertex_color)
{
    const Parts p = parts(material, wi, wo, vertex_color);
    return {{"D", Rgb::grey(p.D)},
            {"G2", Rgb::grey(p.G2)},
            {"V", Rgb::grey(p.V)},
            {"F", p.F},
            {"diffuse", p.diffuse},
            {"specular", p.specular},
            {"sheen", p.sheen},
            {"clearcoat", p.clearcoat},
            {"f", p.f()}};
}

}  // namespace relight
