#include <algorithm>
#include <cmath>

#include "core/base/warp.h"
#include "core/bsdf/fresnel.h"
#include "core/bsdf/material.h"
#include "core/bsdf/mix.h"
#include "core/bsdf/vndf.h"

namespace relight {
namespace {

/// Directions mirrored at facets.
struct Facets {
    double chance = 0.0;
    LobeWidths alpha;
    double turn = 0.0;   ///< of the lobe's x from the tangent, counter-clockwise [rad]
    double gamma = 2.0;  ///< GTR's exponent; 2 is GGX, drawn by what is seen of it
};
/// The chances of the lobes; the cosine lobe has the rest.
struct Lobes {
    Facets specular, coat;
};

double mean(Rgb c)
{
    return (c.r + c.g + c.b) / 3.0;
}

/// Chances in proportion to what each lobe reflects, about. The cosine lobe keeps a tenth: facets
/// of another distribution than the one drawn from have tails that only it reaches.
Lobes weigh(Lobes lobes, double diffuse, double specular, double coat)
{
    const double facets = std::max(0.0, specular) + std::max(0.0, coat);
    if (!(facets > 0.0)) { return {}; }
    const double all = facets + std::max(diffuse, facets / 9.0);
    lobes.specular.chance = std::max(0.0, specular) / all;
    lobes.coat.chance = std::max(0.0, coat) / all;
    return lobes;
}

Lobes lobes(const Lambert& /*material*/, double /*cos_o*/, Rgb /*vertex_color*/)
{
    return {};
}

Lobes lobes(const OrenNayar& /*material*/, double /*cos_o*/, Rgb /*vertex_color*/)
{
    return {};
}

Lobes lobes(const CookTorrance& m, double cos_o, Rgb vertex_color)
{
    const double facet = mean(F(m.fresnel, cos_o));
    double diffuse = (1.0 - facet) * mean(m.albedo_from_vertex ? vertex_color : m.albedo);
    if (m.lost) { diffuse += mean(m.lost->F_ms(m.F_avg)) * (1.0 - m.lost->E(cos_o)); }
    Lobes l;
    l.specular.alpha = {m.alpha_x, m.alpha_y};
    if (m.distribution == Distribution::Gtr) { l.specular.gamma = m.gamma; }
    return weigh(l, diffuse, facet, 0.0);
}

Lobes lobes(const Principled& m, double cos_o, Rgb vertex_color)
{
    const double base = mean(m.base_color_from_vertex ? vertex_color : m.base_color);
    const double grazing = fresnel::schlick(0.0, cos_o);
    const double diffuse = (1.0 - m.metallic) * (base + m.sheen * grazing);
    const double specular = fresnel::schlick(mix(0.08 * m.specular, base, m.metallic), cos_o);
    const double coat = 0.25 * m.clearcoat * fresnel::schlick(0.04, cos_o);
    Lobes l;
    l.specular.alpha = lobe_widths(m);
    l.coat.alpha.x = mix(0.1, 0.001, m.clearcoat_gloss);
    l.coat.gamma = 1.0;
    return weigh(l, diffuse, specular, coat);
}

Lobes lobes(const MetallicRoughness& m, double cos_o, Rgb vertex_color)
{
    const double base = mean(m.base_color_from_vertex ? vertex_color : m.base_color);
    const double r = (m.ior - 1.0) / (m.ior + 1.0);
    const double F0 = std::min(1.0, r * r * mean(m.specular_color)) * m.specular;
    const double F_d = fresnel::schlick(F0, cos_o, m.specular);
    const double coat = m.clearcoat * fresnel::schlick(0.04, cos_o);
    const double specular = mix(F_d, fresnel::schlick(base, cos_o), m.metallic);
    const double diffuse = (1.0 - m.metallic) * (1.0 - F_d) * base + mean(m.sheen_color);
    const double coat_alpha = alpha_from_roughness(m.clearcoat_roughness);
    Lobes l;
    l.specular.alpha = lobe_widths(m);
    l.specular.turn = m.anisotropy_rotation;
    l.coat.alpha = {coat_alpha, coat_alpha};
    return weigh(l, (1.0 - coat) * diffuse, (1.0 - coat) * specular, coat);
}

Lobes lobes_of(const Material& material, Vec3 wo, Rgb vertex_color)
{
    if (!(wo.z > 0.0)) { return {}; }  // f = 0: any direction will do
    return std::visit([&](const auto& m) { return lobes(m, wo.z, vertex_color); }, material);
}

/// Turns w counter-clockwise about the normal.
Vec3 turned(Vec3 w, double angle)
{
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * w.x - s * w.y, s * w.x + c * w.y, w.z};
}

Vec3 draw(const Facets& facets, Vec3 wo, Sample2 s)
{
    const Vec3 o = turned(wo, -facets.turn);
    const Vec3 m = facets.gamma == 2.0 ? vndf::sample(o, facets.alpha.x, facets.alpha.y, s)
                                       : gtr::sample(facets.alpha.x, facets.gamma, s);
    return turned(2.0 * dot(o, m) * m - o, facets.turn);
}

double density(const Facets& facets, Vec3 wi, Vec3 wo)
{
    if (facets.gamma == 2.0) {
        return vndf::pdf_wi(turned(wo, -facets.turn), turned(wi, -facets.turn), facets.alpha.x,
                            facets.alpha.y);
    }
    // m or -m: facets that do not face wo are drawn too, and mirror it to below themselves.
    const Vec3 m = normalize(wi + wo);
    const double cos_d = dot(wo, m);
    if (!(cos_d > 0.0)) { return 0.0; }
    const double cos_m = std::abs(m.z);
    return gtr::D(cos_m, facets.alpha.x, facets.gamma) * cos_m / (4.0 * cos_d);
}

double density(const Lobes& l, Vec3 wi, Vec3 wo)
{
    const double cosine = 1.0 - l.specular.chance - l.coat.chance;
    double sum = cosine * warp::cosine_hemisphere_pdf(wi.z);
    if (l.specular.chance > 0.0) { sum += l.specular.chance * density(l.specular, wi, wo); }
    if (l.coat.chance > 0.0) { sum += l.coat.chance * density(l.coat, wi, wo); }
    return sum;
}

}  // namespace

BsdfSample sample(const Material& material, Vec3 wo, Rgb vertex_color, Sample2 s, double pick)
{
    const Lobes l = lobes_of(material, wo, vertex_color);
    Vec3 wi;
    if (pick < l.specular.chance) {
        wi = draw(l.specular, wo, s);
    } else if (pick < l.specular.chance + l.coat.chance) {
        wi = draw(l.coat, wo, s);
    } else {
        wi = warp::cosine_hemisphere(s);
    }
    return {wi, density(l, wi, wo)};
}

double pdf(const Material& material, Vec3 wi, Vec3 wo, Rgb vertex_color)
{
    return density(lobes_of(material, wo, vertex_color), wi, wo);
}

}  // namespace relight
