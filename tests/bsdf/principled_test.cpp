#include "core/bsdf/principled.h"

#include "core/bsdf/cook_torrance.h"
#include "tests/bsdf/models.h"

namespace relight {
namespace {

constexpr double pi = std::numbers::pi;
const Vec3 up{0.0, 0.0, 1.0};
const Rgb gold{0.9, 0.6, 0.2};

Principled any_principled(test::Random& random)
{
    Principled m;
    m.base_color = test::unit(random) < 0.1 ? Rgb{} : test::any_color(random);
    m.base_color_from_vertex = test::unit(random) < 0.1;
    for (double* weight :
         {&m.metallic, &m.subsurface, &m.specular, &m.roughness, &m.specular_tint, &m.anisotropic,
          &m.sheen, &m.sheen_tint, &m.clearcoat, &m.clearcoat_gloss}) {
        *weight = test::any_weight(random);
    }
    return m;
}

Rgb term_of(const Principled& material, Vec3 wi, Vec3 wo, const char* name)
{
    return test::term(terms(material, wi, wo, {}), name);
}

TEST(Principled, IsReciprocal)
{
    test::expect_reciprocal(any_principled);
}

TEST(Principled, IsFiniteAndNotNegativeForAnyDirections)
{
    test::expect_finite_and_not_negative(any_principled);
}

TEST(Principled, HasTermsThatMakeIt)
{
    test::expect_terms_that_make_f(any_principled, {"diffuse", "sheen", "specular", "clearcoat"});
    test::expect_facets_of_three_factors(any_principled);
}

TEST(Principled, HasEqualWidthsWithoutAnisotropy)
{
    test::Random random(6);
    for (int i = 0; i < 200; ++i) {
        Principled material = any_principled(random);
        material.anisotropic = 0.0;
        EXPECT_EQ(lobe_widths(material).x, lobe_widths(material).y);
        const double cos_i = test::unit(random), cos_o = test::unit(random);
        const double turn = 2.0 * pi * test::unit(random);
        const auto turned = [&](double by) {
            return f(material, test::direction(cos_i, by), test::direction(cos_o, 2.0 + by), {});
        };
        test::expect_near(turned(turn).value, turned(0.0).value, 1e-9);
    }
}

TEST(Principled, StretchesItsLobeAndKeepsItsArea)  // Burley 2012, sec. 5.4
{
    for (const double anisotropic : {0.2, 0.7, 1.0}) {
        Principled material;
        material.anisotropic = anisotropic;
        const LobeWidths alpha = lobe_widths(material);
        EXPECT_NEAR(alpha.x * alpha.y, std::pow(material.roughness, 4), 1e-15);
        EXPECT_NEAR(alpha.y / alpha.x, 1.0 - 0.9 * anisotropic, 1e-15);
        // A facet that leans along x is the likelier one.
        EXPECT_GT(term_of(material, test::direction(0.7, 0.0), up, "D").r,
                  term_of(material, test::direction(0.7, 0.5 * pi), up, "D").r);
    }
    Principled smooth;
    smooth.roughness = 0.0;
    EXPECT_EQ(lobe_widths(smooth).x, least_alpha);
    EXPECT_EQ(lobe_widths(smooth).y, least_alpha);
}

TEST(Principled, OfMetalHasNeitherDiffuseNorSheen)
{
    test::Random random(7);
    for (int i = 0; i < 200; ++i) {
        Principled material = any_principled(random);
        material.metallic = 1.0;
        const Vec3 wi = test::any_direction(random), wo = test::any_direction(random);
        EXPECT_EQ(term_of(material, wi, wo, "diffuse"), Rgb{});
        EXPECT_EQ(term_of(material, wi, wo, "sheen"), Rgb{});
        const Rgb before = f(material, wi, wo, {}).value;
        material.specular = 1.0 - material.specular;  // a dielectric's
        EXPECT_EQ(f(material, wi, wo, {}).value, before);
    }
}

TEST(Principled, OfMetalIsCookTorranceWithSeparateShadowing)
{
    test::Random random(8);
    for (int i = 0; i < 200; ++i) {
        Principled material = any_principled(random);
        material.metallic = 1.0;
        material.clearcoat = 0.0;
        material.base_color_from_vertex = false;
        CookTorrance facets;
        facets.fresnel = SchlickF0{material.base_color};
        facets.shadowing = Shadowing::Separable;
        facets.alpha_x = lobe_widths(material).x;
        facets.alpha_y = lobe_widths(material).y;
        facets = make_cook_torrance(facets);
        const Vec3 wi = test::any_direction(random), wo = test::any_direction(random);
        test::expect_near(f(material, wi, wo, {}).value, f(facets, wi, wo, {}).value, 1e-12);
    }
}

TEST(Principled, HasItsBaseColourHeadOnAndRetroreflectsAtGrazing)
{
    Principled material;
    material.base_color = gold;
    test::expect_near(term_of(material, up, up, "diffuse"), gold / pi, 1e-14);
    for (const double roughness : {0.0, 0.5, 1.0}) {  // toward the light cos_d = 1: F90 = .5 + 2 r
        material.roughness = roughness;
        const Vec3 w = test::direction(1e-6, 0.3);
        const double F90 = 0.5 + 2.0 * roughness;
        test::expect_near(term_of(material, w, w, "diffuse"), gold / pi * F90 * F90, 1e-4);
    }
    material.subsurface = 1.0;  // 1.25 (1 / 2 - 1/2 + 1/2)
    test::expect_near(term_of(material, up, up, "diffuse"), gold / pi * 0.625, 1e-14);
}

TEST(Principled, HasSheenThatGrowsFromNothingTowardTheLightToItsTintAcross)
{
    Principled material;
    material.base_color = gold;
    material.sheen = 0.7;
    EXPECT_EQ(term_of(material, up, up, "sheen"), Rgb{});  // cos_d = 1
    // Light and viewer face to face in the plane: cos_d = 0. White unless tinted.
    const Vec3 wi = test::direction(1e-9, 0.0), wo = test::direction(1e-9, pi);
    material.sheen_tint = 0.0;
    test::expect_near(term_of(material, wi, wo, "sheen"), Rgb::grey(0.7), 1e-7);
    material.sheen_tint = 1.0;
    const Rgb tinted = term_of(material, wi, wo, "sheen");
    test::expect_near(tinted / tinted.g, gold / gold.g, 1e-12);                // the base's hue,
    EXPECT_NEAR(0.3 * tinted.r + 0.6 * tinted.g + 0.1 * tinted.b, 0.7, 1e-7);  // no darker
    material.base_color = {};                                                  // black has no hue
    test::expect_near(term_of(material, wi, wo, "sheen"), Rgb::grey(0.7), 1e-7);
}

TEST(Principled, ReflectsUpToEightPercentHeadOn)
{
    Principled material;
    material.base_color = gold;
    material.specular = 1.0;
    EXPECT_EQ(term_of(material, up, up, "F"), Rgb::grey(0.08));
    material.specular_tint = 1.0;
    const Rgb F0 = term_of(material, up, up, "F");
    EXPECT_NEAR(0.3 * F0.r + 0.6 * F0.g + 0.1 * F0.b, 0.08, 1e-15);
    EXPECT_GT(F0.r, F0.b);
}

TEST(Principled, HasAClearCoatOfAQuarterOfGtrOne)
{
    // Head on G = 1: what is left is strength 1/4, F0 = 0.04, V = 1/4 and the peak of D, whose
    // constant is that of int D cos dm = 1 over (1 + (a^2 - 1) cos^2)^-1.
    Principled material;
    material.clearcoat = 0.6;
    for (const double gloss : {0.0, 0.4, 1.0}) {
        material.clearcoat_gloss = gloss;
        const double a2 = std::pow(0.1 + gloss * (0.001 - 0.1), 2);
        const double peak = (a2 - 1.0) / (pi * std::log(a2) * a2);
        test::expect_near(term_of(material, up, up, "clearcoat"),
                          Rgb::grey(0.6 * 0.25 * 0.04 * 0.25 * peak), 1e-10);
    }
}

TEST(Principled, TakesTheVertexColourOnlyWhenToldTo)
{
    const Vec3 wi = test::direction(0.4, 0.0), wo = test::direction(0.7, 2.0);
    Principled mine, theirs;
    mine.base_color = gold;
    theirs.base_color_from_vertex = true;
    EXPECT_EQ(f(theirs, wi, wo, gold), f(mine, wi, wo, Rgb{}));
}

}  // namespace
}  // namespace relight
