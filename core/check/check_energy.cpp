#include <cmath>
#include <numbers>

#include "core/bsdf/cook_torrance.h"
#include "core/bsdf/vndf.h"
#include "core/check/cases.h"
#include "core/check/materials.h"
#include "core/check/meters.h"
#include "core/check/quadrature.h"

// White furnaces: what comes out of what went in; and the densities of sampled directions.

namespace relight {
namespace {

std::string number(double x)
{
    char text[32];
    std::snprintf(text, sizeof text, "%g", x);
    return text;
}

/// Facets that reflect F0 of all light.
CookTorrance facets(double alpha, double F0, bool multiscatter)
{
    CookTorrance material;
    material.fresnel = SchlickF0{Rgb::grey(F0)};
    material.alpha_x = material.alpha_y = alpha;
    material.multiscatter = multiscatter;
    return make_cook_torrance(material);
}

/// Mean over 32 independent sequences of 512 points each, and its standard error.
template <class Weight>
Drawn mean_of(Weight weight)
{
    constexpr unsigned replicates = 32;
    constexpr std::uint32_t points = 512;
    double sum = 0.0, squares = 0.0;
    for (unsigned r = 0; r < replicates; ++r) {
        const Sequence sequence(9, 8, 7, r);
        double mean = 0.0;
        for (std::uint32_t i = 0; i < points; ++i) { mean += weight(sequence, i) / points; }
        sum += mean;
        squares += mean * mean;
    }
    const double mean = sum / replicates;
    const double variance = std::fmax(0.0, squares / replicates - mean * mean);
    return {mean, std::sqrt(variance / (replicates - 1))};
}

/// int f cos_i dwi. Not for lobes narrower than a tenth.
double albedo(const Material& material, double cos_o)
{
    const Vec3 wo = quadrature::direction(cos_o, 0.0);
    return quadrature::over_zone([&](Vec3 wi) { return f(material, wi, wo, {}).value.r * wi.z; },
                                 0.0, 1.0, 20, 200);
}

void check_albedo(Cases& cases)
{
    cases.group("energy", "1");
    for (const double alpha : {0.1, 0.4, 1.0}) {
        const CookTorrance plain = facets(alpha, 1.0, false);
        double most = 0.0;
        for (const double c : {0.1, 0.3, 0.6, 1.0}) { most = std::fmax(most, albedo(plain, c)); }
        cases.absolute("white facets give back no more than they get, alpha " + number(alpha),
                       "max(0, int f cos dwi - 1) = 0", 0.0, std::fmax(0.0, most - 1.0), 1e-4);
        const CookTorrance full = facets(alpha, 1.0, true);
        for (const double c : {0.3, 0.9}) {
            cases.absolute("white furnace of facets with multiple scattering, alpha " +
                               number(alpha) + ", cos_o " + number(c),
                           "int (f + f_ms) cos dwi = 1", 1.0, albedo(full, c), 2e-3);
        }
    }
    // A lobe this narrow is integrated over the facets that are seen: f cos_i dwi = F G2/G1 D_v dm.
    const CookTorrance mirror = facets(0.01, 0.5, false);
    const Vec3 wo = quadrature::direction(0.5, 0.0);
    double reflected = 0.0;
    constexpr std::uint32_t points = 4096;
    const Sequence sequence(5, 6, 7, 8);
    for (std::uint32_t i = 0; i < points; ++i) {
        const Vec3 m = vndf::sample(wo, 0.01, 0.01, sequence.at(i, 0));
        const Vec3 wi = m * (2.0 * dot(wo, m)) - wo;
        if (!(wi.z > 0.0)) { continue; }
        reflected +=
            f(mirror, wi, wo, {}).value.r * wi.z / vndf::pdf_wi(wo, wi, 0.01, 0.01) / points;
    }
    cases.relative("all but smooth facets are a mirror, cos_o 0.5", "albedo -> F = F0 + (1-F0)/32",
                   0.5 + 0.5 / 32.0, reflected, 5e-3);
}

void check_furnace_by_walk(Cases& cases)
{
    cases.group("energy", "W/(m2 sr)");
    const Mesh ground = quads({{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}});
    Scene scene = lit_by({light_of(EnvironmentLight{}, 2.0)}, 16384);
    scene.materials = {facets(0.5, 1.0, true)};
    cases.relative("white facets with multiple scattering under a constant sky", "L = L_sky", 2.0,
                   read(ground, {Meter{}}, scene)[0].Lo, 0.01);
}

}  // namespace

void check_energy(Cases& cases)
{
    check_albedo(cases);
    check_furnace_by_walk(cases);
}

void check_material_samples(Cases& cases)
{
    cases.group("material samples", "1");
    const Vec3 wo = quadrature::direction(0.6, 0.0);
    // Densities of facets end abruptly where the halfway vector lies in the surface (cos_i =
    // -cos_o), cosine lobes have their kink on the horizon.
    const auto over_sphere = [&](auto density) {
        return quadrature::over_zone(density, -1.0, -wo.z, 4, 200) +
               quadrature::over_zone(density, -wo.z, 0.0, 20, 200) +
               quadrature::over_zone(density, 0.0, 1.0, 30, 200);
    };
    cases.relative("density of light off seen facets, alpha 0.3 and 0.5", "int pdf dwi = 1", 1.0,
                   over_sphere([&](Vec3 wi) { return vndf::pdf_wi(wo, wi, 0.3, 0.5); }), 1e-4);
    for (const NamedMaterial& material : reciprocal_materials()) {
        // GTR draws facets as seen from above: those that face away from wo send nothing anywhere.
        if (material.name == "cook_torrance GTR") { continue; }
        cases.relative("density of directions drawn for " + material.name, "int pdf dwi = 1", 1.0,
                       over_sphere([&](Vec3 wi) { return pdf(material.value, wi, wo, {}); }), 1e-3);
    }
    // What is drawn agrees with its density: two ways to the same albedo.
    for (const NamedMaterial& material : reciprocal_materials()) {
        const auto weight = [&](const Sequence& sequence, std::uint32_t i) {
            const BsdfSample drawn =
                sample(material.value, wo, {}, sequence.at(i, 0), sequence.at(i, 1).u);
            if (!(drawn.wi.z > 0.0)) { return 0.0; }
            return f(material.value, drawn.wi, wo, {}).value.r * drawn.wi.z / drawn.pdf;
        };
        cases.drawn("mean of f cos / pdf over samples of " + material.name,
                    "albedo = int f cos dwi", albedo(material.value, wo.z), mean_of(weight), 1e-4);
    }
}

}  // namespace relight
