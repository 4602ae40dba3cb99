#include "core/bsdf/cook_torrance.h"

#include <algorithm>
#include <cassert>
#include <numbers>

#include "core/bsdf/beckmann.h"
#include "core/bsdf/fresnel.h"
#include "core/bsdf/ggx.h"
#include "core/bsdf/smith.h"

namespace relight {
namespace {

struct FresnelAt {
    double u;

    Rgb operator()(const SchlickF0& m) const
    {
        return {fresnel::schlick(m.F0.r, u), fresnel::schlick(m.F0.g, u),
                fresnel::schlick(m.F0.b, u)};
    }
    Rgb operator()(const DielectricIor& m) const
    {
        return Rgb::grey(fresnel::dielectric(m.ior, u));
    }
    Rgb operator()(const ConductorEtaK& m) const
    {
        return {fresnel::conductor(m.eta.r, m.k.r, u), fresnel::conductor(m.eta.g, m.k.g, u),
                fresnel::conductor(m.eta.b, m.k.b, u)};
    }
};

double D(const CookTorrance& m, Vec3 h)
{
    switch (m.distribution) {
        case Distribution::Beckmann:
            return beckmann::D(h, m.alpha_x, m.alpha_y);
        case Distribution::Ggx:
            return ggx::D(h, m.alpha_x, m.alpha_y);
        case Distribution::Gtr:
            return gtr::D(h.z, m.alpha_x, m.gamma);
    }
    return 0.0;
}

double Lambda_cos(const CookTorrance& m, Vec3 w)
{
    switch (m.distribution) {
        case Distribution::Beckmann:
            return beckmann::Lambda_cos(w, m.alpha_x, m.alpha_y);
        case Distribution::Ggx:
            return ggx::Lambda_cos(w, m.alpha_x, m.alpha_y);
        case Distribution::Gtr:
            assert(m.gtr_masking);
            return m.gtr_masking->Lambda_cos(w);
    }
    return 0.0;
}

/// The lobe of white facets: D V, f with F = 1.
struct Lobe {
    double D = 0.0, V = 0.0;
};
Lobe lobe(const CookTorrance& m, Vec3 wi, Vec3 wo, Vec3 h)
{
    const auto V =
        m.shadowing == Shadowing::Separable ? smith::V_separable : smith::V_height_correlated;
    return {D(m, h), V(wi.z, Lambda_cos(m, wi), wo.z, Lambda_cos(m, wo))};
}

/// Everything that f is made of; f and terms share it, so that they agree to the bit.
struct Parts {
    Lobe facets;
    Rgb F, base, specular, multiscatter, f;
};
Parts parts(const CookTorrance& m, Vec3 wi, Vec3 wo, Rgb vertex_color)
{
    const Dir3 h = normalize(wi + wo);
    Parts p;
    p.facets = lobe(m, wi, wo, h);
    p.F = F(m.fresnel, dot(wi, h));
    const Rgb rho = m.albedo_from_vertex ? vertex_color : m.albedo;
    p.base = (Rgb::grey(1.0) - p.F) * rho / std::numbers::pi;
    p.specular = p.F * (p.facets.D * p.facets.V);
    if (m.lost) { p.multiscatter = m.lost->f_ms(wi.z, wo.z, m.F_avg); }
    p.f = p.base + p.specular + p.multiscatter;
    return p;
}

}  // namespace

CookTorrance make_cook_torrance(CookTorrance material)
{
    material.alpha_x = std::max(least_alpha, material.alpha_x);
    material.alpha_y = std::max(least_alpha, material.alpha_y);
    if (material.distribution == Distribution::Gtr) {
        material.alpha_y = material.alpha_x = std::min(1.0, material.alpha_x);
        if (material.gamma == 2.0) {
            material.distribution = Distribution::Ggx;
        } else {
            material.gtr_masking =
                std::make_shared<const gtr::Masking>(material.alpha_x, material.gamma);
        }
    }
    if (material.multiscatter) {
        const auto mirror = [&](Vec3 wi, Vec3 wo) {
            const Lobe facets = lobe(material, wi, wo, normalize(wi + wo));
            return facets.D * facets.V;
        };
        material.lost =
            std::make_shared<const MultiscatterTable>(mirror, material.alpha_x, material.alpha_y);
        material.F_avg = F_avg(material.fresnel);
    }
    return material;
}

Rgb F(const FresnelModel& model, double u)
{
    return std::visit(FresnelAt{u}, model);
}

Rgb F_avg(const FresnelModel& model)
{
    if (const auto* schlick = std::get_if<SchlickF0>(&model)) {
        return {fresnel::schlick_mean(schlick->F0.r), fresnel::schlick_mean(schlick->F0.g),
                fresnel::schlick_mean(schlick->F0.b)};
    }
    // F is 1 up to the cosine of the critical angle (a lighter dielectric behind the boundary) and
    // leaves it as a square root: u = critical + (1 - critical) t^2 makes it smooth, and Simpson's
    // rule in t exact to 1e-7.
    const auto* dielectric = std::get_if<DielectricIor>(&model);
    const double ior = dielectric == nullptr ? 1.0 : std::min(1.0, dielectric->ior);
    const double critical = std::sqrt((1.0 - ior) * (1.0 + ior));
    const double rest = 1.0 - critical;
    constexpr int steps = 256;
    Rgb sum;
    for (int i = 0; i <= steps; ++i) {
        const double t = static_cast<double>(i) / steps;
        const double u = critical + rest * t * t;
        const double weight = i == 0 || i == steps ? 1.0 : (i % 2 == 1 ? 4.0 : 2.0);
        sum += F(model, u) * (weight * u * 2.0 * t);
    }
    return Rgb::grey(critical * critical) + sum * (2.0 * rest / (3.0 * steps));
}

BsdfValue f(const CookTorrance& material, Vec3 wi, Vec3 wo, Rgb vertex_color)
{
    if (!(wi.z > 0.0 && wo.z > 0.0)) { return {}; }
    return {parts(material, wi, wo, vertex_color).f};
}

std::vector<BsdfTerm> terms(const CookTorrance& material, Vec3 wi, Vec3 wo, Rgb vertex_color)
{
    Parts p;
    if (wi.z > 0.0 && wo.z > 0.0) { p = parts(material, wi, wo, vertex_color); }
    return {{"D", Rgb::grey(p.facets.D)},
            {"G2", Rgb::grey(p.facets.V * 4.0 * wi.z * wo.z)},
            {"F", p.F},
            {"base", p.base},
            {"specular", p.specular},
            {"multiscatter", p.multiscatter},
            {"f", p.f}};
}

}  // namespace relight
