#include "core/bsdf/metallic_roughness.h"

#include "core/bsdf/cook_torrance.h"
#include "core/bsdf/fresnel.h"
#include "core/bsdf/lambert.h"
#include "tests/bsdf/models.h"

namespace relight {
namespace {

constexpr double pi = std::numbers::pi;
const Vec3 up{0.0, 0.0, 1.0};
const Rgb gold{0.9, 0.6, 0.2};

MetallicRoughness any_plain(test::Random& random)
{
    MetallicRoughness m;
    m.base_color = test::any_color(random);
    m.metallic = test::any_weight(random);
    m.roughness = test::any_weight(random);
    return m;
}
MetallicRoughness any_uncoated(test::Random& random)
{
    MetallicRoughness m = any_plain(random);
    m.base_color_from_vertex = test::unit(random) < 0.1;
    m.ior = test::unit(random) < 0.1 ? 0.0 : 1.0 + 2.0 * test::any_weight(random);
    m.specular = test::any_weight(random);
    m.specular_color = test::any_color(random) * 4.0;
    m.sheen_color = test::any_color(random) * test::any_weight(random);
    m.sheen_roughness = test::any_weight(random);
    m.anisotropy_strength = test::any_weight(random);
    m.anisotropy_rotation = 10.0 * test::unit(random);
    return m;
}
MetallicRoughness any_coated(test::Random& random)
{
    MetallicRoughness m = any_uncoated(random);
    m.clearcoat = test::any_weight(random);
    m.clearcoat_roughness = test::any_weight(random);
    return m;
}
MetallicRoughness plastic(double roughness)
{
    MetallicRoughness m;
    m.base_color = gold;
    m.metallic = 0.0;
    m.roughness = roughness;
    return m;
}

Rgb term_of(const MetallicRoughness& material, Vec3 wi, Vec3 wo, const char* name)
{
    return test::term(terms(material, wi, wo, {}), name);
}

TEST(MetallicRoughness, IsReciprocalWithoutAClearCoat)
{
    test::expect_reciprocal(any_uncoated);
}

TEST(MetallicRoughness, IsFiniteAndNotNegativeForAnyDirections)
{
    test::expect_finite_and_not_negative(any_coated);
}

TEST(MetallicRoughness, HasTermsThatMakeIt)
{
    test::expect_terms_that_make_f(any_coated, {"diffuse", "specular", "sheen", "clearcoat"});
    test::expect_facets_of_three_factors([](test::Random& random) {
        MetallicRoughness m = any_uncoated(random);
        m.sheen_color = {};  // layers above dim the specular
        return m;
    });
}

TEST(MetallicRoughness, WithoutExtensionsIsAppendixB)  // glTF 2.0, B.2 and B.3, as it is printed
{
    test::Random random(1);
    for (int i = 0; i < 500; ++i) {
        const MetallicRoughness material = any_plain(random);
        const Vec3 l = test::any_direction(random), v = test::any_direction(random);
        const Vec3 h = normalize(l + v);
        const double a2 = std::pow(std::max(1e-3, std::pow(material.roughness, 2)), 2);
        const double D = a2 / (pi * std::pow(h.x * h.x + h.y * h.y + a2 * h.z * h.z, 2));
        const auto root = [&](double c) { return std::sqrt(a2 + (1.0 - a2) * c * c); };
        const double specular = D * 0.5 / (l.z * root(v.z) + v.z * root(l.z));
        const double w = std::pow(1.0 - std::abs(dot(v, h)), 5);
        const auto band = [&](double base) {
            const double F = 0.04 + 0.96 * w;
            const double dielectric = (1.0 - F) * base / pi + F * specular;
            const double metal = specular * (base + (1.0 - base) * w);
            return (1.0 - material.metallic) * dielectric + material.metallic * metal;
        };
        const Rgb c = material.base_color;
        test::expect_near(f(material, l, v, {}).value, {band(c.r), band(c.g), band(c.b)}, 1e-9);
    }
}

TEST(MetallicRoughness, OfMetalHasNoDiffuseAndCaresForNoDielectricsField)
{
    test::Random random(2);
    for (int i = 0; i < 200; ++i) {
        MetallicRoughness metal = any_uncoated(random);
        metal.metallic = 1.0;
        const Vec3 wi = test::any_direction(random), wo = test::any_direction(random);
        EXPECT_EQ(term_of(metal, wi, wo, "diffuse"), Rgb{});
        const Rgb before = f(metal, wi, wo, {}).value;
        metal.ior = 1.3;
        metal.specular = 0.2;
        metal.specular_color = {0.1, 0.2, 0.3};
        EXPECT_EQ(f(metal, wi, wo, {}).value, before);
    }
}

TEST(MetallicRoughness, TakesTheVertexColourOnlyWhenToldTo)
{
    const Vec3 wi = test::direction(0.4, 0.0), wo = test::direction(0.7, 2.0);
    MetallicRoughness theirs = plastic(0.5);
    theirs.base_color_from_vertex = true;
    EXPECT_EQ(f(theirs, wi, wo, gold), f(plastic(0.5), wi, wo, Rgb{}));
    EXPECT_NE(f(theirs, wi, wo, Rgb{}), f(plastic(0.5), wi, wo, Rgb{}));
}

TEST(Ior, GivesTheFresnelEquationsReflectanceHeadOn)
{
    for (const double ior : {1.0, 1.33, 1.5, 2.42, 100.0}) {
        MetallicRoughness material = plastic(0.5);
        material.ior = ior;
        const double F = fresnel::dielectric(ior, 1.0);
        EXPECT_NEAR(term_of(material, up, up, "F").g, F, 1e-15);
        test::expect_near(term_of(material, up, up, "diffuse"), gold / pi * (1.0 - F), 1e-12);
    }
}

TEST(Ior, OfOneShowsNoBoundaryHeadOn)
{
    MetallicRoughness material = plastic(0.5);
    material.ior = 1.0;
    EXPECT_EQ(term_of(material, up, up, "specular"), Rgb{});
    EXPECT_EQ(f(material, up, up, {}), f(Lambert{gold}, up, up, {}));
}

TEST(Ior, OfZeroReflectsWholly)  // KHR_materials_ior: F is 1 for every direction
{
    test::Random random(3);
    MetallicRoughness material = plastic(0.5);
    material.ior = 0.0;
    for (int i = 0; i < 100; ++i) {
        const Vec3 wi = test::any_direction(random), wo = test::any_direction(random);
        EXPECT_EQ(term_of(material, wi, wo, "F"), Rgb::grey(1.0));
        EXPECT_EQ(term_of(material, wi, wo, "diffuse"), Rgb{});
    }
}

TEST(Specular, OfZeroLeavesTheLambertianBase)
{
    test::Random random(4);
    MetallicRoughness material = plastic(0.3);
    material.specular = 0.0;
    for (int i = 0; i < 100; ++i) {
        const Vec3 wi = test::any_direction(random), wo = test::any_direction(random);
        EXPECT_EQ(f(material, wi, wo, {}), f(Lambert{gold}, wi, wo, {}));
    }
}

TEST(Specular, WeighsTheReflectionAtEveryAngle)
{
    test::Random random(5);
    MetallicRoughness whole = plastic(0.3), part = plastic(0.3);
    part.specular = 0.4;
    for (int i = 0; i < 100; ++i) {
        const Vec3 wi = test::any_direction(random), wo = test::any_direction(random);
        const Rgb F = term_of(whole, wi, wo, "F");
        test::expect_near(term_of(part, wi, wo, "F"), F * 0.4, 1e-12);
        test::expect_near(term_of(part, wi, wo, "diffuse"), gold / pi * (1.0 - 0.4 * F.g), 1e-12);
    }
}

TEST(Specular, IsColouredHeadOnAndWhiteAtGrazing)
{
    MetallicRoughness material = plastic(0.3);
    material.specular_color = {2.0, 1.0, 0.5};
    test::expect_near(term_of(material, up, up, "F"), {0.08, 0.04, 0.02}, 1e-14);
    // What the base gets is the light that no band reflects more of: its colour stays.
    test::expect_near(term_of(material, up, up, "diffuse"), gold / pi * (1.0 - 0.08), 1e-14);
    const Vec3 wi = test::direction(1e-9, 0.0), wo = test::direction(1e-9, pi);
    test::expect_near(term_of(material, wi, wo, "F"), Rgb::grey(1.0), 1e-7);
    material.specular_color = {1e3, 1.0, 0.0};  // clamped before the weight
    material.specular = 0.5;
    test::expect_near(term_of(material, up, up, "F"), {0.5, 0.02, 0.0}, 1e-14);
}

TEST(Anisotropy, WidensTheTangentsDirectionOnly)
{
    MetallicRoughness material = plastic(0.5);
    material.anisotropy_strength = 0.6;
    EXPECT_NEAR(lobe_widths(material).x, 0.25 + 0.36 * (1.0 - 0.25), 1e-15);
    EXPECT_EQ(lobe_widths(material).y, 0.25);
    material.anisotropy_strength = 1.0;
    EXPECT_EQ(lobe_widths(material).x, 1.0);
}

TEST(Anisotropy, TurnedByAQuarterSwapsTheWidths)
{
    test::Random random(6);
    for (int i = 0; i < 100; ++i) {
        MetallicRoughness metal = any_plain(random);
        metal.metallic = 1.0;
        metal.anisotropy_strength = test::unit(random);
        CookTorrance facets;  // proven by its own oracle
        facets.fresnel = SchlickF0{metal.base_color};
        const Vec3 wi = test::any_direction(random), wo = test::any_direction(random);
        for (const bool quarter : {false, true}) {
            metal.anisotropy_rotation = quarter ? 0.5 * pi : 0.0;
            facets.alpha_x = quarter ? lobe_widths(metal).y : lobe_widths(metal).x;
            facets.alpha_y = quarter ? lobe_widths(metal).x : lobe_widths(metal).y;
            test::expect_near(f(metal, wi, wo, {}).value,
                              f(make_cook_torrance(facets), wi, wo, {}).value, 1e-9);
        }
    }
}

TEST(Anisotropy, TurnsCounterClockwiseFromTheTangent)
{
    MetallicRoughness metal;
    metal.roughness = 0.3;
    metal.anisotropy_strength = 0.8;
    const auto D_toward = [&](double azimuth) {
        return term_of(metal, test::direction(0.6, azimuth), up, "D").r;
    };
    const double along = D_toward(0.0);
    metal.anisotropy_rotation = 0.7;
    EXPECT_NEAR(D_toward(0.7) / along, 1.0, 1e-12);
    EXPECT_LT(D_toward(-0.7), 0.9 * along);
}

TEST(Clearcoat, IsAMirrorLobeUnderTheFresnelOfTheViewAngle)
{
    test::Random random(7);
    for (int i = 0; i < 200; ++i) {
        const MetallicRoughness coated = any_coated(random);
        MetallicRoughness bare = coated;
        bare.clearcoat = 0.0;
        CookTorrance mirror;
        mirror.fresnel = SchlickF0{Rgb::grey(1.0)};
        mirror.alpha_x = mirror.alpha_y = alpha_from_roughness(coated.clearcoat_roughness);
        const Vec3 wi = test::any_direction(random), wo = test::any_direction(random);
        const double share = coated.clearcoat * fresnel::schlick(0.04, wo.z);
        const Rgb over = f(make_cook_torrance(mirror), wi, wo, {}).value * share;
        const Rgb under = f(bare, wi, wo, {}).value * (1.0 - share);
        test::expect_near(term_of(coated, wi, wo, "clearcoat"), over, 1e-9);
        test::expect_near(f(coated, wi, wo, {}).value, over + under, 1e-9);
    }
}

/// As published the coat's share is that of the view angle alone: only what it is a share of can
/// change places with itself.
TEST(Clearcoat, IsReciprocalOnlyPerUnitOfItsFresnel)
{
    test::Random random(8);
    double worst = 0.0;
    for (int i = 0; i < 200; ++i) {
        MetallicRoughness coated = any_coated(random), bare = coated;
        bare.clearcoat = 0.0;
        coated.clearcoat = 1.0;
        const Vec3 wi = test::any_direction(random), wo = test::any_direction(random);
        const auto change = [&](Vec3 to_light, Vec3 to_viewer) {
            return (f(coated, to_light, to_viewer, {}).value.g -
                    f(bare, to_light, to_viewer, {}).value.g) /
                   fresnel::schlick(0.04, to_viewer.z);
        };
        const double scale = f(bare, wi, wo, {}).value.g + std::abs(change(wi, wo));
        EXPECT_NEAR(change(wi, wo), change(wo, wi), 1e-9 * scale / 0.04);
        const double there = f(coated, wi, wo, {}).value.g, back = f(coated, wo, wi, {}).value.g;
        worst = std::max(worst, std::abs(there / back - 1.0));
    }
    EXPECT_GT(worst, 0.1);
}

TEST(Clearcoat, OfNoRoughnessReflectsItsFresnelAndPassesOnTheRest)
{
    MetallicRoughness material = plastic(1.0);
    material.base_color = Rgb::grey(1.0);
    material.specular = 0.0;  // a white Lambertian base: together they lose and gain nothing
    material.clearcoat = 1.0;
    for (const double cos_o : {0.2, 0.5, 1.0}) {
        const Vec3 wo = test::direction(cos_o, 0.4);
        const double share = test::over_facets(
            [&](Vec3 h) {  // dwi = 4 (wo.h) dh
                const Vec3 wi = 2.0 * dot(wo, h) * h - wo;
                if (wi.z <= 0.0 || dot(wo, h) <= 0.0) { return 0.0; }
                return term_of(material, wi, wo, "clearcoat").g * wi.z * 4.0 * dot(wo, h);
            },
            least_alpha, 64, 0.1);
        EXPECT_NEAR(share, fresnel::schlick(0.04, cos_o), 0.005 * share);
        const double passed = term_of(material, wo, wo, "diffuse").g * pi;
        EXPECT_NEAR(share + passed, 1.0, 1e-3);
    }
}

TEST(Emission, IsDarkenedByTheClearCoatTowardGrazing)
{
    MetallicRoughness lamp;
    lamp.emissive = {1.0, 0.5, 0.0};
    lamp.emissive_strength = 300.0;
    EXPECT_EQ(emission(lamp, 0.1), (Rgb{300.0, 150.0, 0.0}));
    lamp.clearcoat = 0.5;
    test::expect_near(emission(lamp, 1.0), lamp.emissive * (300.0 * 0.98), 1e-14);
    test::expect_near(emission(lamp, 0.0), lamp.emissive * (300.0 * 0.5), 1e-14);
}

}  // namespace
}  // namespace relight
