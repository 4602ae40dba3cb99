#include <gtest/gtest.h>

#include "core/base/random.h"
#include "core/bsdf/material.h"
#include "core/bsdf/multiscatter.h"
#include "tests/bsdf/quadrature.h"
#include "tests/chi2.h"

namespace relight {
namespace {

struct Sampled {
    std::string name;
    Material material;
    double alpha_x = 1.0, alpha_y = 1.0;  ///< of its narrowest lobe, for the quadrature,
    double turn = 0.0;                    ///< and how it is turned
};
constexpr Rgb vertex_color{0.2, 0.5, 0.7};
const FresnelModel metal = ConductorEtaK{Rgb::grey(0.2), Rgb::grey(3.9)};

CookTorrance facets(Distribution distribution, double ax, double ay, FresnelModel fresnel,
                    double gamma = 2.0)
{
    CookTorrance m;
    m.distribution = distribution;
    m.alpha_x = ax;
    m.alpha_y = ay;
    m.gamma = gamma;
    m.fresnel = fresnel;
    return m;
}

std::vector<Sampled> cook_torrances()
{
    std::vector<Sampled> all;
    const auto add = [&](const std::string& name, const CookTorrance& m) {
        all.push_back({name, make_cook_torrance(m), m.alpha_x, m.alpha_y});
    };
    CookTorrance plastic = facets(Distribution::Ggx, 0.05, 0.05, DielectricIor{1.5});
    plastic.albedo_from_vertex = true;
    add("plastic", plastic);
    add("mirror", facets(Distribution::Ggx, 1e-3, 1e-3, metal));
    add("brushed metal", facets(Distribution::Ggx, 0.1, 0.5, metal));
    add("beckmann", facets(Distribution::Beckmann, 0.3, 0.3, metal));
    add("stretched beckmann", facets(Distribution::Beckmann, 0.6, 0.2, SchlickF0{}));
    add("gtr of long tails", facets(Distribution::Gtr, 0.2, 0.2, metal, 0.5));
    add("gtr 1", facets(Distribution::Gtr, 0.05, 0.05, metal, 1.0));
    add("gtr of short tails", facets(Distribution::Gtr, 0.4, 0.4, metal, 6.0));
    CookTorrance rough = facets(Distribution::Ggx, 0.8, 0.8, metal);
    rough.multiscatter = true;
    add("compensated", rough);
    return all;
}

std::vector<Sampled> principleds()
{
    Principled base;
    base.base_color = {0.7, 0.4, 0.1};
    Principled brushed = base;
    brushed.metallic = 1.0;
    brushed.roughness = 0.4;
    brushed.anisotropic = 0.8;
    Principled lacquer = base;
    lacquer.clearcoat = 1.0;
    lacquer.base_color_from_vertex = true;
    Principled cloth = base;
    cloth.sheen = 1.0;
    cloth.subsurface = 1.0;
    cloth.roughness = 1.0;
    cloth.specular = 0.0;
    Principled dull = base;
    dull.clearcoat = 1.0;
    dull.clearcoat_gloss = 0.0;
    dull.metallic = 0.5;
    const double ax = lobe_widths(brushed).x, ay = lobe_widths(brushed).y;
    return {{"disney", base, 0.25, 0.25},
            {"disney brushed", brushed, ax, ay},
            {"disney lacquer", lacquer, 1e-3, 1e-3},
            {"disney cloth", cloth},
            {"disney dull coat", dull, 0.1, 0.1}};
}

std::vector<Sampled> gltfs()
{
    MetallicRoughness plastic;
    plastic.metallic = 0.0;
    plastic.roughness = 0.3;
    plastic.base_color_from_vertex = true;
    MetallicRoughness coated;
    coated.roughness = 0.7;
    coated.clearcoat = 1.0;
    coated.clearcoat_roughness = 0.2;
    MetallicRoughness turned;
    turned.roughness = 0.4;
    turned.anisotropy_strength = 0.8;
    turned.anisotropy_rotation = 0.7;
    MetallicRoughness velvet = plastic;
    velvet.sheen_color = {0.9, 0.3, 0.1};
    velvet.sheen_roughness = 0.4;
    velvet.roughness = 1.0;
    MetallicRoughness shiny = plastic;
    shiny.ior = 0.0;
    MetallicRoughness tinted = plastic;
    tinted.specular = 0.5;
    tinted.specular_color = {3.0, 0.5, 0.0};
    tinted.metallic = 0.3;
    const LobeWidths alpha = lobe_widths(turned);
    return {{"gltf", MetallicRoughness{}},       {"gltf plastic", plastic, 0.09, 0.09},
            {"gltf coated", coated, 0.04, 0.04}, {"gltf turned", turned, alpha.x, alpha.y, 0.7},
            {"gltf velvet", velvet, 0.16, 0.16}, {"gltf of ior 0", shiny, 0.09, 0.09},
            {"gltf tinted", tinted, 0.09, 0.09}};
}

/// Every model, with parameters that bring out every lobe it has.
const std::vector<Sampled>& all_materials()
{
    static const std::vector<Sampled> materials = [] {
        OrenNayar plaster;
        plaster.sigma = 0.6;
        std::vector<Sampled> all{{"lambert", Lambert{}}, {"oren-nayar", plaster}};
        for (const auto& model : {cook_torrances(), principleds(), gltfs()}) {
            all.insert(all.end(), model.begin(), model.end());
        }
        return all;
    }();
    return materials;
}

const std::vector<Vec3> views{{0.0, 0.0, 1.0},
                              test::direction(0.7, 2.5),
                              test::direction(0.2, -1.0),
                              test::direction(0.01, 0.4)};

BsdfSample draw(const Material& material, Vec3 wo, std::uint64_t seed, int i)
{
    const auto n = static_cast<std::uint64_t>(i);
    return sample(material, wo, vertex_color, {uniform(seed, 0, n, 0), uniform(seed, 0, n, 1)},
                  uniform(seed, 0, n, 2));
}

Vec3 reflect(Vec3 w, Vec3 m)
{
    return 2.0 * dot(w, m) * m - w;
}

TEST(BsdfSampling, EveryModelDrawsFromTheDensityItClaims)
{
    // Facets h of the upper hemisphere mirror wo to the whole sphere of wi, each direction once:
    // p(h) = p(wi) 4 |wo.h|. There lobes are about the pole, however narrow, and at grazing too.
    constexpr int n = 10000;
    std::uint64_t seed = 0;
    for (const Sampled& m : all_materials()) {
        for (const Vec3 wo : views) {
            SCOPED_TRACE(m.name + ", cos_o = " + std::to_string(wo.z));
            ++seed;
            const auto facet = [&](int i) {
                const Vec3 h = normalize(draw(m.material, wo, seed, i).wi + wo);
                return h.z < 0.0 ? -h : h;
            };
            const auto density = [&](Vec3 h) {
                if (h.z <= 0.0) { return 0.0; }
                return pdf(m.material, reflect(wo, h), wo, vertex_color) * 4.0 *
                       std::abs(dot(wo, h));
            };
            const auto result = test::chi2_directions(facet, density, n);
            EXPECT_GT(result.p, 1e-3) << result.statistic << " of " << result.degrees;
            EXPECT_NEAR(result.integral, 1.0, 1e-3);
        }
    }
}

/// int f cos_i dwi by quadrature, in the frame of the narrowest lobe.
double albedo(const Sampled& m, Vec3 wo)
{
    const auto turned = [](Vec3 w, double angle) {
        const double c = std::cos(angle), s = std::sin(angle);
        return Vec3{c * w.x - s * w.y, s * w.x + c * w.y, w.z};
    };
    return directional_albedo(
        [&](Vec3 wi, Vec3 o) {
            return f(m.material, turned(wi, m.turn), turned(o, m.turn), vertex_color).value.g;
        },
        turned(wo, -m.turn), m.alpha_x, m.alpha_y);
}

TEST(BsdfSampling, ItsEstimateOfTheAlbedoIsTheIntegral)
{
    constexpr int n = 4000;
    double squared_errors = 0.0;
    int estimates = 0, beyond_3 = 0;
    std::uint64_t seed = 1000;
    for (const Sampled& m : all_materials()) {
        for (const Vec3 wo : views) {
            SCOPED_TRACE(m.name + ", cos_o = " + std::to_string(wo.z));
            ++seed;
            double sum = 0.0, squares = 0.0;
            for (int i = 0; i < n; ++i) {
                const BsdfSample s = draw(m.material, wo, seed, i);
                if (s.wi.z <= 0.0) { continue; }
                const double x = f(m.material, s.wi, wo, vertex_color).value.g * s.wi.z / s.pdf;
                sum += x;
                squares += x * x;
            }
            const double mean = sum / n;
            const double error = std::sqrt(std::max(0.0, squares / n - mean * mean) / n);
            const double expected = albedo(m, wo);
            EXPECT_LE(std::abs(mean - expected), 4.0 * error + 1e-4 * expected)
                << mean << " for " << expected;
            if (error < 1e-4 * expected) { continue; }  // drawn as f itself: nothing varies
            squared_errors += std::pow((mean - expected) / error, 2);
            beyond_3 += std::abs(mean - expected) > 3.0 * error ? 1 : 0;
            ++estimates;
        }
    }
    EXPECT_LE(beyond_3, 2);
    const double rms = std::sqrt(squared_errors / estimates);
    EXPECT_GT(rms, 0.7);  // or the errors are not what they claim to be
    EXPECT_LT(rms, 1.35);
}

TEST(BsdfSampling, DensityIsPositiveWhereverTheModelReflects)
{
    std::vector<Vec3> directions{{0, 0, 1}, {1, 0, 1e-12}, {-1, 0, 1e-12}, {0, 0, -1}, {1, 0, 0}};
    for (std::uint64_t i = 0; i < 60; ++i) {
        const double z = std::pow(uniform(3, 0, i, 0), i % 2 == 0 ? 1.0 : 8.0);  // grazing too
        directions.push_back(test::direction(z, 2.0 * std::numbers::pi * uniform(3, 0, i, 1)));
    }
    for (const Sampled& m : all_materials()) {
        SCOPED_TRACE(m.name);
        for (const Vec3 wi : directions) {
            for (const Vec3 wo : directions) {
                const double p = pdf(m.material, wi, wo, vertex_color);
                ASSERT_TRUE(std::isfinite(p) && p >= 0.0) << p;
                const Rgb value = f(m.material, wi, wo, vertex_color).value;
                if (value.r + value.g + value.b > 0.0) { ASSERT_GT(p, 0.0) << wi.z << ' ' << wo.z; }
            }
        }
    }
}

TEST(BsdfSampling, ASampleIsAUnitDirectionWithThePdfOfItsOwn)
{
    constexpr double last = 1.0 - 0x1p-53;
    for (const Sampled& m : all_materials()) {
        SCOPED_TRACE(m.name);
        for (const Vec3 wo : {Vec3{0, 0, 1}, test::direction(1e-12, 1.0), Vec3{1, 0, 1e-300},
                              test::direction(0.4, 4.0), Vec3{0, 1, 0}, Vec3{0, 0, -1}}) {
            for (const double u : {0.0, 0.3, last}) {
                for (const double v : {0.0, 0.5, last}) {
                    for (const double pick : {0.0, 0.5, last}) {
                        const BsdfSample s = sample(m.material, wo, vertex_color, {u, v}, pick);
                        ASSERT_NEAR(length(s.wi), 1.0, 1e-9);
                        ASSERT_EQ(s.pdf, pdf(m.material, s.wi, wo, vertex_color));
                        ASSERT_TRUE(std::isfinite(s.pdf) && s.pdf >= 0.0);
                        if (s.wi.z > 0.0) { ASSERT_GT(s.pdf, 0.0) << wo.z << ' ' << u; }
                    }
                }
            }
        }
    }
}

TEST(Material, TermsEndInFToTheBit)
{
    for (const Sampled& m : all_materials()) {
        SCOPED_TRACE(m.name);
        for (const Vec3 wo : views) {
            for (const double c : {-0.5, 0.0, 1e-9, 0.3, 1.0}) {
                const Vec3 wi = test::direction(c, 0.9);
                const std::vector<BsdfTerm> factors = terms(m.material, wi, wo, vertex_color);
                ASSERT_FALSE(factors.empty());
                EXPECT_EQ(factors.back().name, "f");
                EXPECT_EQ(factors.back().value, f(m.material, wi, wo, vertex_color).value);
            }
        }
    }
}

TEST(Material, DiffuseAlbedoIsTheBaseLessTheMetal)
{
    const Rgb base{0.2, 0.4, 0.6};
    Principled disney;
    disney.base_color = base;
    disney.metallic = 0.25;
    MetallicRoughness gltf;
    gltf.base_color = base;
    gltf.metallic = 0.25;
    CookTorrance plastic;
    plastic.albedo = base;
    OrenNayar plaster;
    plaster.albedo = base;
    for (const Material& m : {Material{Lambert{base}}, Material{plaster}, Material{plastic}}) {
        EXPECT_EQ(diffuse_albedo(m, vertex_color), base);
    }
    for (const Material& m : {Material{disney}, Material{gltf}}) {
        EXPECT_EQ(diffuse_albedo(m, vertex_color), base * 0.75);
    }
    disney.base_color_from_vertex = gltf.base_color_from_vertex = true;
    plastic.albedo_from_vertex = plaster.albedo_from_vertex = true;
    for (const Material& m :
         {Material{Lambert{base, true}}, Material{plaster}, Material{plastic}}) {
        EXPECT_EQ(diffuse_albedo(m, vertex_color), vertex_color);
    }
    for (const Material& m : {Material{disney}, Material{gltf}}) {
        EXPECT_EQ(diffuse_albedo(m, vertex_color), vertex_color * 0.75);
    }
    // What is called Lambertian reflects so, and has no more than it.
    for (const Sampled& m : all_materials()) {
        if (!is_lambertian(m.material)) { continue; }
        EXPECT_NEAR(albedo(m, views[1]), diffuse_albedo(m.material, vertex_color).g, 1e-5);
    }
}

TEST(Material, IsLambertianOrAnisotropicWhereFSaysSo)
{
    EXPECT_TRUE(is_lambertian(OrenNayar{}));  // sigma = 0
    for (const Sampled& m : all_materials()) {
        SCOPED_TRACE(m.name);
        const auto value = [&](double turn) {
            return f(m.material, test::direction(0.5, turn), test::direction(0.8, 2.0 + turn),
                     vertex_color)
                .value.g;
        };
        const double spread = std::abs(value(1.0) / value(0.0) - 1.0);
        if (is_anisotropic(m.material)) {
            EXPECT_GT(spread, 1e-3);
        } else {
            EXPECT_LT(spread, 1e-9);
        }
        const Rgb straight = f(m.material, {0, 0, 1}, {0, 0, 1}, vertex_color).value;
        const Rgb slanted = f(m.material, test::direction(0.3, 2.5), views[1], vertex_color).value;
        EXPECT_EQ(is_lambertian(m.material), straight == slanted);
    }
}

TEST(Material, EmitsWhatItsCoatLetsThrough)
{
    EXPECT_EQ(emission(Lambert{}), Rgb{});
    EXPECT_EQ(emission(Principled{}), Rgb{});
    MetallicRoughness lamp;
    lamp.emissive = {0.5, 1.0, 0.0};
    lamp.emissive_strength = 8.0;
    EXPECT_EQ(emission(lamp), (Rgb{4.0, 8.0, 0.0}));
    EXPECT_EQ(emission(lamp, 0.1), (Rgb{4.0, 8.0, 0.0}));
    lamp.clearcoat = 1.0;
    EXPECT_NEAR(emission(lamp).g, 8.0 * 0.96, 1e-12);  // 4 % stay inside at normal incidence,
    EXPECT_NEAR(emission(lamp, 0.0).g, 0.0, 1e-12);    // all of it at grazing
}

}  // namespace
}  // namespace relight
