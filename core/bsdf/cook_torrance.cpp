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
    return material;
}

Rgb F(const FresnelModel& model, double u)
{
    return std::visit(FresnelAt{u}, model);
}

BsdfValue f(const CookTorrance& material, Vec3 wi, Vec3 wo, Rgb vertex_color)
{
    if (!(wi.z > 0.0 && wo.z > 0.0)) { return {}; }
    const Dir3 h = normalize(wi + wo);
    const Rgb facet = F(material.fresnel, dot(wi, h));
    const auto V = material.shadowing == Shadowing::Separable ? smith::V_separable
                                                              : smith::V_height_correlated;
    const double mirror =
        D(material, h) * V(wi.z, Lambda_cos(material, wi), wo.z, Lambda_cos(material, wo));
    const Rgb rho = material.albedo_from_vertex ? vertex_color : material.albedo;
    const Rgb base = (Rgb::grey(1.0) - facet) * rho / std::numbers::pi;
    return {base + facet * mirror};
}

}  // namespace relight
