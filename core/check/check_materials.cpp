#include <cmath>
#include <numbers>

#include "core/check/cases.h"
#include "core/check/materials.h"
#include "core/check/meters.h"
#include "core/check/quadrature.h"

// Values of f that can be worked out by hand, reciprocity, and Lambert's law through the walk.

namespace relight {
namespace {

constexpr double pi = std::numbers::pi;

double straight_on(const Material& material)
{
    return f(material, {0, 0, 1}, {0, 0, 1}, {}).value.r;
}

/// Straight on every half angle is 0, every masking 1, and Fresnel's terms are at normal incidence.
void check_values(Cases& cases)
{
    cases.group("material", "1/sr");
    const double alpha = 0.25, D = 1.0 / (pi * alpha * alpha);  // roughness 0.5
    cases.relative("lambert", "f = rho / pi", 0.7 / pi, straight_on(Lambert{Rgb::grey(0.7)}),
                   1e-12);
    const double s2 = 0.3 * 0.3;
    cases.relative("oren_nayar straight on", "f = rho / pi (1 - s^2 / (2 (s^2 + 0.33)))",
                   0.7 / pi * (1.0 - 0.5 * s2 / (s2 + 0.33)),
                   straight_on(OrenNayar{Rgb::grey(0.7), false, 0.3}), 1e-12);
    cases.relative("oren_nayar without slopes is lambert", "f = rho / pi", 0.7 / pi,
                   f(OrenNayar{Rgb::grey(0.7), false, 0.0}, quadrature::direction(0.3, 1.0),
                     quadrature::direction(0.8, 2.0), {})
                       .value.r,
                   1e-12);
    CookTorrance metal;
    metal.fresnel = SchlickF0{Rgb::grey(0.6)};
    metal.alpha_x = metal.alpha_y = alpha;
    cases.relative("cook_torrance straight on", "f = F0 D(1) / 4, D(1) = 1 / (pi alpha^2)",
                   0.6 * D / 4.0, straight_on(make_cook_torrance(metal)), 1e-12);
    Principled disney;
    disney.base_color = Rgb::grey(0.4);
    disney.roughness = 0.5;
    disney.specular = 0.5;
    cases.relative("principled straight on", "f = base / pi + 0.08 specular D(1) / 4",
                   0.4 / pi + 0.04 * D / 4.0, straight_on(disney), 1e-12);
    disney.clearcoat = 1.0;
    disney.clearcoat_gloss = 0.0;  // alpha = 0.1
    const double coat = (0.01 - 1.0) / (pi * std::log(0.01) * 0.01);
    cases.relative("principled with a clear coat straight on",
                   "f = base / pi + (0.04 D(1) + 0.25 x 0.04 D_GTR1(1)) / 4",
                   0.4 / pi + 0.04 * D / 4.0 + 0.25 * 0.04 * coat / 4.0, straight_on(disney),
                   1e-12);
    disney.metallic = 1.0;
    disney.clearcoat = 0.0;
    cases.relative("principled metal straight on", "f = base D(1) / 4", 0.4 * D / 4.0,
                   straight_on(disney), 1e-12);
    MetallicRoughness gltf;
    gltf.base_color = Rgb::grey(0.4);
    gltf.roughness = 0.5;
    gltf.metallic = 0.0;
    cases.relative("metallic_roughness dielectric straight on",
                   "f = 0.96 base / pi + 0.04 D(1) / 4", 0.96 * 0.4 / pi + 0.04 * D / 4.0,
                   straight_on(gltf), 1e-12);
    gltf.metallic = 1.0;
    cases.relative("metallic_roughness metal straight on", "f = base D(1) / 4", 0.4 * D / 4.0,
                   straight_on(gltf), 1e-12);
    gltf.clearcoat = 1.0;
    gltf.clearcoat_roughness = 0.5;
    cases.relative("metallic_roughness metal under a clear coat straight on",
                   "f = (0.96 base + 0.04) D(1) / 4", (0.96 * 0.4 + 0.04) * D / 4.0,
                   straight_on(gltf), 1e-12);
}

void check_reciprocity(Cases& cases)
{
    cases.group("reciprocity", "1");
    for (const NamedMaterial& material : reciprocal_materials()) {
        double most = 0.0;
        for (const double a : {0.05, 0.4, 0.75, 0.98}) {
            for (const double b : {0.1, 0.5, 0.9}) {
                for (int j = 0; j < 6; ++j) {
                    const Vec3 wi = quadrature::direction(a, 0.2),
                               wo = quadrature::direction(b, 0.5 + j);
                    const Rgb there = f(material.value, wi, wo, {}).value;
                    const Rgb back = f(material.value, wo, wi, {}).value;
                    for (const auto& [x, y] :
                         {std::pair{there.r, back.r}, std::pair{there.g, back.g},
                          std::pair{there.b, back.b}}) {
                        // A material that is dark both ways proves nothing.
                        most = std::fmax(most, x > 0.0 ? std::abs(y / x - 1.0) : 1.0);
                    }
                }
            }
        }
        cases.absolute("light and eye change places: " + material.name,
                       "max |f(wo, wi) / f(wi, wo) - 1| = 0", 0.0, most, 1e-9);
    }
}

void check_lambert(Cases& cases)
{
    cases.group("Lambert", "W/(m2 sr)");
    const double rho = 0.7, I = 5.0;
    Scene scene = lit_by({light_of(PointLight{{0, 0, 2}, {}}, I)});
    scene.materials = {Lambert{Rgb::grey(rho)}};
    cases.relative("radiance of a matt surface under a point light", "L = rho E / pi",
                   rho * I / 4.0 / pi, read(floor_with_block(), {Meter{}}, scene)[0].Lo);
    scene.lights = {light_of(EnvironmentLight{}, 1.7)};
    scene.materials = {Lambert{Rgb::grey(1.0)}};
    cases.relative(
        "white matt surface under a constant sky is as bright as it", "L = L_sky", 1.7,
        read(quads({{-9, -9, 0}, {9, -9, 0}, {9, 9, 0}, {-9, 9, 0}}), {Meter{}}, scene)[0].Lo);
    CookTorrance metal;
    metal.fresnel = SchlickF0{Rgb::grey(0.6)};
    scene.lights = {light_of(PointLight{{0, 0, 2}, {}}, I)};
    scene.materials = {make_cook_torrance(metal)};
    cases.relative("radiance of a rough metal, light and eye straight above",
                   "L = F0 / (4 pi alpha^2) I / h^2", 0.6 / (4.0 * pi * 0.0625) * I / 4.0,
                   read(floor_with_block(), {Meter{}}, scene)[0].Lo);
    cases.group("Lambert", "W/m2");
    const double M = quadrature::over_zone(
        [&](Vec3 wo) {
            return f(Lambert{Rgb::grey(rho)}, quadrature::direction(0.6, 0), wo, {}).value.r * wo.z;
        },
        0.0, 1.0, 2, 8);
    cases.relative("exitance of a matt surface", "M = int rho/pi E cos dw = rho E", rho, M, 1e-9);
}

}  // namespace

std::vector<NamedMaterial> reciprocal_materials()
{
    const Rgb color{0.8, 0.5, 0.2};
    CookTorrance metal;
    metal.albedo = color;
    metal.fresnel = ConductorEtaK{{0.2, 0.4, 1.4}, {3.4, 2.4, 1.6}};
    metal.alpha_x = metal.alpha_y = 0.3;
    CookTorrance beckmann = metal, gtr = metal, brushed = metal, full = metal, separable = metal;
    beckmann.distribution = Distribution::Beckmann;
    gtr.distribution = Distribution::Gtr;
    gtr.gamma = 1.5;
    brushed.alpha_y = 0.6;
    full.multiscatter = true;
    separable.shadowing = Shadowing::Separable;
    separable.fresnel = DielectricIor{1.6};
    Principled disney;
    disney.base_color = color;
    disney.metallic = 0.3;
    disney.subsurface = disney.specular_tint = disney.sheen = disney.clearcoat = 0.6;
    disney.anisotropic = 0.5;
    disney.clearcoat_gloss = 0.2;
    MetallicRoughness gltf;
    gltf.base_color = color;
    gltf.metallic = 0.4;
    gltf.roughness = 0.6;
    gltf.anisotropy_strength = 0.5;
    gltf.anisotropy_rotation = 0.7;
    MetallicRoughness cloth = gltf;
    cloth.metallic = 0.0;
    cloth.sheen_color = {0.5, 0.6, 0.7};
    cloth.sheen_roughness = 0.7;
    return {{"lambert", Lambert{color}},
            {"oren_nayar", OrenNayar{color, false, 0.4}},
            {"cook_torrance GGX", make_cook_torrance(metal)},
            {"cook_torrance Beckmann", make_cook_torrance(beckmann)},
            {"cook_torrance GTR", make_cook_torrance(gtr)},
            {"cook_torrance anisotropic", make_cook_torrance(brushed)},
            {"cook_torrance separable, dielectric", make_cook_torrance(separable)},
            {"cook_torrance multiscatter", make_cook_torrance(full)},
            {"principled", disney},
            {"metallic_roughness anisotropic", gltf},
            {"metallic_roughness sheen", cloth}};
}

void check_materials(Cases& cases)
{
    check_values(cases);
    check_reciprocity(cases);
    check_lambert(cases);
}

}  // namespace relight
