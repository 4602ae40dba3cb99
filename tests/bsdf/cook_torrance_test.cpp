#include "core/bsdf/cook_torrance.h"

#include <gtest/gtest.h>

#include <random>

#include "core/bsdf/beckmann.h"
#include "core/bsdf/fresnel.h"
#include "core/bsdf/ggx.h"
#include "core/bsdf/smith.h"
#include "tests/bsdf/quadrature.h"

namespace relight {
namespace {

constexpr double pi = std::numbers::pi;

CookTorrance facets(Distribution distribution, double alpha, FresnelModel fresnel,
                    double gamma = 2.0)
{
    CookTorrance material;
    material.distribution = distribution;
    material.alpha_x = material.alpha_y = alpha;
    material.gamma = gamma;
    material.fresnel = fresnel;
    return make_cook_torrance(material);
}
const FresnelModel mirror = SchlickF0{Rgb::grey(1.0)};  // F = 1: nothing is lost but by masking

Vec3 reflect(Vec3 w, Vec3 m)
{
    return 2.0 * dot(w, m) * m - w;
}

/// int f cos_i dwi, summed over half vectors: each reflects wo to a wi with dwi = 4 (wo.h) dh.
double albedo(const CookTorrance& material, Vec3 wo, int turns = 128)
{
    return test::over_facets(
        [&](Vec3 h) {
            const Vec3 wi = reflect(wo, h);
            const double cos_d = dot(wo, h);
            if (cos_d <= 0.0 || wi.z <= 0.0) { return 0.0; }
            return f(material, wi, wo, {}).value.g * wi.z * 4.0 * cos_d;
        },
        material.alpha_x, turns, 0.05);
}

TEST(CookTorrance, NeverReflectsMoreThanItReceives)  // white furnace
{
    for (const double a : {1e-3, 0.01, 0.1, 0.4, 1.0}) {
        for (const double cos_o : {0.02, 0.1, 0.4, 0.8, 1.0}) {
            SCOPED_TRACE(testing::Message() << "alpha = " << a << ", cos_o = " << cos_o);
            const Vec3 wo = test::direction(cos_o, 0.4);
            for (const auto distribution : {Distribution::Ggx, Distribution::Beckmann}) {
                const double share = albedo(facets(distribution, a, mirror), wo);
                EXPECT_LE(share, 1.0 + 1e-4);
                EXPECT_GT(share, 0.3);  // not by being dark
            }
            const double share = albedo(facets(Distribution::Gtr, a, mirror, 1.3), wo);
            EXPECT_LE(share, 1.0 + 1e-4);
            EXPECT_GT(share, 0.25);
        }
    }
}

TEST(CookTorrance, TurnsIntoAMirrorAsItGetsSmooth)
{
    for (const double cos_o : {0.3, 0.5, 0.9}) {
        const Vec3 wo = test::direction(cos_o, 0.0);
        for (const FresnelModel& model :
             {mirror, FresnelModel{DielectricIor{1.5}}, FresnelModel{SchlickF0{}},
              FresnelModel{ConductorEtaK{Rgb::grey(0.2), Rgb::grey(3.9)}}}) {
            const double expected = F(model, cos_o).g;
            EXPECT_NEAR(albedo(facets(Distribution::Ggx, 0.01, model), wo) / expected, 1.0, 0.005);
            EXPECT_NEAR(albedo(facets(Distribution::Beckmann, 0.01, model), wo) / expected, 1.0,
                        0.005);
        }
    }
}

TEST(CookTorrance, VisibleFacetsReflectEveryRayOnce)  // weak white furnace, Heitz 2014 sec. 5.3
{
    // int over the whole sphere of wi of G1(wo) D(h) / (4 cos_o) = 1, D being 0 where h is below,
    // that is where wi.z <= -wo.z. With wo at azimuth 0 the peak (the mirror direction) and the
    // point where h has no limit (wi = -wo) are at azimuth pi: panels crowd there, and toward wi.z
    // = -wo.z.
    const auto furnace = [](auto D, double G1, Vec3 wo) {
        const auto at_height = [&](double z) {
            const auto half_turn = [&](double t) {
                const double phi = pi * (1.0 - t * t * t);
                return D(normalize(test::direction(z, phi) + wo)) * 3.0 * pi * t * t;
            };
            return 2.0 * test::over_interval(half_turn, 0.0, 1.0, 60);
        };
        const double reach = 1.0 + wo.z;
        const auto height = [&](double t) {
            return at_height(-wo.z + reach * t * t) * 2.0 * reach * t;
        };
        return G1 * test::over_interval(height, 0.0, 1.0, 150) / (4.0 * wo.z);
    };
    for (const double a : {0.05, 0.2, 1.0}) {
        for (const double cos_o : {0.2, 0.7, 0.98}) {
            SCOPED_TRACE(testing::Message() << "alpha = " << a << ", cos_o = " << cos_o);
            const Vec3 wo = test::direction(cos_o, 0.0);
            EXPECT_NEAR(furnace([&](Vec3 h) { return ggx::D(h, a, a); },
                                smith::G1(cos_o, ggx::Lambda_cos(wo, a, a)), wo),
                        1.0, 1e-4);
            EXPECT_NEAR(furnace([&](Vec3 h) { return beckmann::D(h, a, a); },
                                smith::G1(cos_o, beckmann::Lambda_cos(wo, a, a)), wo),
                        1.0, 1e-4);
        }
    }
}

/// dw_h/dw_i at (wi, wo) by central differences: area of the patch h sweeps on the sphere while wi
/// sweeps a small square.
double half_vector_jacobian(Vec3 wi, Vec3 wo)
{
    const double e = 1e-4;
    const Frame frame = frame_around(normalize(wi));
    const auto h = [&](Vec3 offset) -> Vec3 {
        return normalize(Vec3(normalize(wi + offset)) + wo);
    };
    const auto slope = [&](Vec3 axis) {
        const Vec3 once = h(e * axis) - h(-e * axis);
        const Vec3 twice = h(2.0 * e * axis) - h(-2.0 * e * axis);
        return (8.0 * once - twice) / (12.0 * e);
    };
    return length(cross(slope(frame.x), slope(frame.y)));
}

TEST(CookTorrance, HasTheFourOfTheHalfVectorsJacobian)
{
    // What leaves toward wo from light of E_perp = 1/dwi: facets D dw_h, seen share, projected. So
    // f cos_i = F G2 D (wo.h)/cos_o dw_h/dw_i, and dw_h/dw_i = 1 / (4 wi.h).
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> cosine(0.1, 1.0), turn(0.0, 2.0 * pi);
    const double a = 0.4;
    const CookTorrance material = facets(Distribution::Ggx, a, mirror);
    for (int i = 0; i < 50; ++i) {
        const Vec3 wi = test::direction(cosine(random), turn(random));
        const Vec3 wo = test::direction(cosine(random), turn(random));
        const Vec3 h = normalize(wi + wo);
        const double jacobian = half_vector_jacobian(wi, wo);
        EXPECT_NEAR(jacobian * 4.0 * dot(wi, h), 1.0, 1e-6);
        const double G2 =
            1.0 / (1.0 + ggx::Lambda_cos(wi, a, a) / wi.z + ggx::Lambda_cos(wo, a, a) / wo.z);
        const double expected = G2 * ggx::D(h, a, a) * dot(wo, h) / wo.z * jacobian;
        EXPECT_NEAR(f(material, wi, wo, {}).value.r * wi.z / expected, 1.0, 1e-6);
    }
}

CookTorrance random_material(std::mt19937_64& random)
{
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const auto rgb = [&] { return Rgb{unit(random), unit(random), unit(random)}; };
    CookTorrance m;
    m.albedo = rgb();
    const double kind = unit(random);
    m.distribution = kind < 0.3   ? Distribution::Beckmann
                     : kind < 0.9 ? Distribution::Ggx
                                  : Distribution::Gtr;
    m.alpha_x = alpha_from_roughness(unit(random));
    m.alpha_y = unit(random) < 0.5 ? m.alpha_x : alpha_from_roughness(unit(random));
    m.gamma = 0.1 + 9.9 * unit(random);
    m.shadowing = unit(random) < 0.5 ? Shadowing::Separable : Shadowing::HeightCorrelated;
    const double optics = unit(random);
    if (optics < 0.3) {
        m.fresnel = SchlickF0{rgb()};
    } else if (optics < 0.6) {
        m.fresnel = DielectricIor{0.5 + 3.0 * unit(random)};
    } else {
        m.fresnel = ConductorEtaK{rgb() * 4.0, rgb() * 8.0};
    }
    return make_cook_torrance(m);
}

TEST(CookTorrance, IsReciprocal)
{
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> cosine(1e-3, 1.0), turn(0.0, 2.0 * pi);
    for (int i = 0; i < 300; ++i) {
        const CookTorrance material = random_material(random);
        for (int j = 0; j < 30; ++j) {
            const Vec3 wi = test::direction(cosine(random), turn(random));
            const Vec3 wo = test::direction(cosine(random), turn(random));
            const Rgb there = f(material, wi, wo, {}).value, back = f(material, wo, wi, {}).value;
            EXPECT_NEAR(there.r, back.r, 1e-9 * there.r);
            EXPECT_NEAR(there.g, back.g, 1e-9 * there.g);
            EXPECT_NEAR(there.b, back.b, 1e-9 * there.b);
        }
    }
}

TEST(CookTorrance, IsFiniteAndNotNegativeForAnyDirections)
{
    std::mt19937_64 random(9);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::uniform_int_distribution<int> choice(0, 5);
    const auto direction = [&]() -> Vec3 {
        const double height = std::pow(10.0, -320.0 * std::abs(unit(random)));
        switch (choice(random)) {
            case 0:
                return {0.0, 0.0, 1.0};
            case 1:
                return normalize({unit(random), unit(random), height});
            case 2:
                return {1.0, 0.0, height};
            case 3:
                return {-1.0, 0.0, height};
            case 4:
                return normalize({1e-200, 1e-9 * unit(random), 1.0});
            default:
                return normalize({unit(random), unit(random), unit(random)});
        }
    };
    for (int i = 0; i < 300; ++i) {
        const CookTorrance material = random_material(random);
        for (int j = 0; j < 300; ++j) {
            const Vec3 wi = direction();
            const Vec3 wo = j % 10 == 0 ? wi : direction();
            const Rgb value = f(material, wi, wo, {}).value;
            for (const double band : {value.r, value.g, value.b}) {
                ASSERT_TRUE(std::isfinite(band)) << wi.z << ' ' << wo.z;
                ASSERT_GE(band, 0.0) << wi.z << ' ' << wo.z;
            }
            if (wi.z <= 0.0 || wo.z <= 0.0) { ASSERT_EQ(value, Rgb{}); }
        }
    }
}

TEST(CookTorrance, TurnsWithTheSurfaceWhenItsWidthsAreEqual)
{
    const CookTorrance material = facets(Distribution::Beckmann, 0.3, mirror);
    const auto value = [&](double turn) {
        return f(material, test::direction(0.5, 0.2 + turn), test::direction(0.8, 2.2 + turn), {})
            .value.r;
    };
    for (const double turn : {0.3, 1.0, 3.0}) { EXPECT_NEAR(value(turn) / value(0.0), 1.0, 1e-12); }
}

TEST(CookTorrance, LendsItsBaseOnlyWhatTheFacetsLetThrough)
{
    const Vec3 wi = test::direction(0.3, 0.0), wo = test::direction(0.6, 2.0);
    const double u = dot(wi, normalize(wi + wo));
    CookTorrance material = facets(Distribution::Ggx, 0.2, DielectricIor{1.5});
    const Rgb black = f(material, wi, wo, {}).value;
    material.albedo = {0.2, 0.4, 0.8};
    const Rgb base = f(material, wi, wo, {}).value - black;
    const double through = (1.0 - fresnel::dielectric(1.5, u)) / pi;
    EXPECT_NEAR(base.r, 0.2 * through, 1e-12);
    EXPECT_NEAR(base.b, 0.8 * through, 1e-12);
    material.albedo_from_vertex = true;
    EXPECT_NEAR((f(material, wi, wo, {0.5, 0.5, 0.5}).value - black).r, 0.5 * through, 1e-12);
}

TEST(CookTorrance, OfGtrTwoIsGgxAndOfNearlyTwoNearlyThat)
{
    const Vec3 wi = test::direction(0.1, 0.0), wo = test::direction(0.4, 2.7);
    const double expected = f(facets(Distribution::Ggx, 0.2, mirror), wi, wo, {}).value.g;
    const double two = f(facets(Distribution::Gtr, 0.2, mirror, 2.0), wi, wo, {}).value.g;
    const double nearly = f(facets(Distribution::Gtr, 0.2, mirror, 2.0 + 1e-8), wi, wo, {}).value.g;
    EXPECT_NEAR(two / expected, 1.0, 1e-12);
    EXPECT_NEAR(nearly / expected, 1.0, 1e-6);
}

TEST(CookTorrance, KeepsItsWidthsAboveTheFloor)
{
    const CookTorrance made = facets(Distribution::Ggx, 0.0, mirror);
    EXPECT_EQ(made.alpha_x, least_alpha);
    EXPECT_EQ(made.alpha_y, least_alpha);
}

}  // namespace
}  // namespace relight
