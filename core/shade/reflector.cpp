#include "core/shade/reflector.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "core/bsdf/charlie.h"
#include "core/bsdf/mix.h"

namespace relight::kernel {
namespace {

float to_f(double x)
{
    return static_cast<float>(x);
}

void copy(float (&to)[3], Rgb from)
{
    to[0] = to_f(from.r);
    to[1] = to_f(from.g);
    to[2] = to_f(from.b);
}

Facets facets_of(LobeWidths alpha, double peak)
{
    return {to_f(1.0 / (alpha.x * alpha.x)), to_f(1.0 / (alpha.y * alpha.y)),
            to_f(alpha.x * alpha.x), to_f(alpha.y * alpha.y), to_f(peak)};
}

Facets ggx(LobeWidths alpha)
{
    return facets_of(alpha, 1.0 / (std::numbers::pi * alpha.x * alpha.y));
}

Boundary boundary_of(double n, double k)
{
    constexpr double mirror = 1e8;  // F is 1 to the precision of a float; squares stay in range
    n = std::min(n, mirror);
    k = std::min(k, mirror);
    const std::complex<double> less{(n - 1.0) * (n + 1.0) - k * k, 2.0 * n * k};
    return {to_f(std::abs(less)), to_f(less.real() + 1.0), to_f(less.real()),
            to_f(less.real() + 2.0), to_f(less.imag())};
}

struct Prepare {
    Reflector& r;
    std::vector<float>&gtr, &lost, &sheen;

    void operator()(const Lambert& /*m*/) { r.model = Reflector::Model::Lambert; }

    void operator()(const OrenNayar& m)
    {
        r.model = Reflector::Model::OrenNayar;
        const double s2 = m.sigma * m.sigma;
        r.A = to_f(1.0 - 0.5 * s2 / (s2 + 0.33));
        r.B = to_f(0.45 * s2 / (s2 + 0.09));
    }

    void operator()(const CookTorrance& m)
    {
        r.separable = m.shadowing == Shadowing::Separable;
        r.inv_alpha = to_f(1.0 / m.alpha_x);
        r.facets = ggx({m.alpha_x, m.alpha_y});
        r.model = m.distribution == Distribution::Beckmann ? Reflector::Model::Beckmann
                                                           : Reflector::Model::Ggx;
        if (m.distribution == Distribution::Gtr) {
            r.model = Reflector::Model::Gtr;
            r.facets.peak = to_f(gtr::D_peak(m.alpha_x, m.gamma));
            r.gamma = to_f(m.gamma);
            gtr.assign(m.gtr_masking->log_ratios().begin(), m.gtr_masking->log_ratios().end());
            r.gtr_table = gtr.data();
            r.gtr_scale = to_f(1.0 / m.gtr_masking->step());
        }
        if (const auto* schlick = std::get_if<SchlickF0>(&m.fresnel)) {
            copy(r.F0, schlick->F0);
        } else if (const auto* dielectric = std::get_if<DielectricIor>(&m.fresnel)) {
            r.boundaries = 1;
            r.boundary[0] = boundary_of(dielectric->ior, 0.0);
        } else {
            const auto& [eta, k] = std::get<ConductorEtaK>(m.fresnel);
            r.boundaries = 3;
            r.boundary[0] = boundary_of(eta.r, k.r);
            r.boundary[1] = boundary_of(eta.g, k.g);
            r.boundary[2] = boundary_of(eta.b, k.b);
        }
        if (!m.lost || m.lost->E_avg() >= 1.0) { return; }
        for (const double E : m.lost->E_at_nodes()) { lost.push_back(to_f(1.0 - E)); }
        r.lost_table = lost.data();
        r.lost_inv_scale = to_f(1.0 / m.lost->scale());
        r.lost_inv_reach = to_f(1.0 / m.lost->reach());
        copy(r.F_ms, m.lost->F_ms(m.F_avg) / (std::numbers::pi * (1.0 - m.lost->E_avg())));
    }

    void operator()(const Principled& m)
    {
        r.model = Reflector::Model::Principled;
        r.facets = ggx(lobe_widths(m));
        r.metallic = to_f(m.metallic);
        r.roughness = to_f(m.roughness);
        r.subsurface = to_f(m.subsurface);
        r.specular = to_f(0.08 * m.specular);
        r.specular_tint = to_f(m.specular_tint);
        r.sheen = to_f(m.sheen);
        r.sheen_tint = to_f(m.sheen_tint);
        // Of D: the width of its GTR of exponent 1; of V: 0.25.
        const double alpha = mix(0.1, 0.001, m.clearcoat_gloss);
        r.coat = facets_of({alpha, alpha}, gtr::D_peak(alpha, 1.0));
        r.clearcoat = to_f(0.25 * m.clearcoat);
    }

    void operator()(const MetallicRoughness& m)
    {
        r.model = Reflector::Model::MetallicRoughness;
        r.turn_cos = std::cos(m.anisotropy_rotation);
        r.turn_sin = std::sin(m.anisotropy_rotation);
        r.facets = ggx(lobe_widths(m));
        r.metallic = to_f(m.metallic);
        r.specular = to_f(m.specular);
        const double n = (m.ior - 1.0) / (m.ior + 1.0);
        const auto F0 = [&](double color) { return std::min(n * n * color, 1.0) * m.specular; };
        const Rgb c = m.specular_color;
        copy(r.F0, {F0(c.r), F0(c.g), F0(c.b)});
        r.F0_strongest = std::max({r.F0[0], r.F0[1], r.F0[2]});
        r.clearcoat = to_f(m.clearcoat);
        const double coat = alpha_from_roughness(m.clearcoat_roughness);
        r.coat = ggx({coat, coat});
        copy(r.sheen_color, m.sheen_color);
        r.strongest_sheen = std::max({r.sheen_color[0], r.sheen_color[1], r.sheen_color[2]});
        if (!(r.strongest_sheen > 0.0F)) { return; }
        const double alpha = alpha_from_roughness(m.sheen_roughness);
        r.charlie_exponent = to_f(0.5 / alpha);
        r.charlie_norm = to_f((2.0 + 1.0 / alpha) / (2.0 * std::numbers::pi));
        const auto fit = charlie::Lambda_fit(alpha);
        std::transform(fit.begin(), fit.end(), r.charlie_fit, to_f);
        const auto [a, b, c_, d, e] = fit;
        r.charlie_middle = to_f(2.0 * (a / (1.0 + b * std::pow(0.5, c_)) + d * 0.5 + e));
        const auto E = charlie::E_over_cosines(alpha);
        sheen.assign(E.begin(), E.end());
        r.sheen_table = sheen.data();
    }
};

}  // namespace

PreparedMaterial::PreparedMaterial(const Material& material)
{
    std::visit(Prepare{reflector, gtr_, lost_, sheen_}, material);
    reflector.anisotropic = is_anisotropic(material);
}

}  // namespace relight::kernel
