#include "core/bsdf/oren_nayar.h"

#include "core/bsdf/lambert.h"
#include "tests/bsdf/models.h"

namespace relight {
namespace {

constexpr double pi = std::numbers::pi;

OrenNayar any_oren_nayar(test::Random& random)
{
    return {test::any_color(random), test::unit(random) < 0.2, 0.5 * pi * test::any_weight(random)};
}

TEST(Lambert, HasTermsThatMakeIt)
{
    const auto any_lambert = [](test::Random& random) {
        return Lambert{test::any_color(random), test::unit(random) < 0.5};
    };
    test::expect_terms_that_make_f(any_lambert, {"diffuse"});
}

TEST(OrenNayar, IsReciprocal)
{
    test::expect_reciprocal(any_oren_nayar);
}

TEST(OrenNayar, IsFiniteAndNotNegativeForAnyDirections)
{
    test::expect_finite_and_not_negative(any_oren_nayar);
}

TEST(OrenNayar, HasTermsThatMakeIt)
{
    test::expect_terms_that_make_f(any_oren_nayar, {"diffuse"});
}

TEST(OrenNayar, WithoutSlopesIsLambert)
{
    test::Random random(2);
    for (int i = 0; i < 100; ++i) {
        const Rgb rho = test::any_color(random), vertex = test::any_color(random);
        const bool from_vertex = i % 2 == 0;
        const Vec3 wi = test::any_direction(random), wo = test::any_direction(random);
        EXPECT_EQ(f(OrenNayar{rho, from_vertex, 0.0}, wi, wo, vertex),
                  f(Lambert{rho, from_vertex}, wi, wo, vertex));
    }
}

TEST(OrenNayar, IsThePapersFormulaInAngles)  // Oren & Nayar 1994, eq. 30
{
    test::Random random(1);
    for (int i = 0; i < 300; ++i) {
        const OrenNayar material{test::any_color(random), false, 0.5 * pi * test::unit(random)};
        const Vec3 wi = test::any_direction(random), wo = test::any_direction(random);
        const double theta_i = std::acos(wi.z), theta_o = std::acos(wo.z);
        const double dphi = std::atan2(wi.y, wi.x) - std::atan2(wo.y, wo.x);
        const double s2 = std::pow(material.sigma, 2);
        const double A = 1.0 - 0.5 * s2 / (s2 + 0.33), B = 0.45 * s2 / (s2 + 0.09);
        const double shape = A + B * std::max(0.0, std::cos(dphi)) *
                                     std::sin(std::max(theta_i, theta_o)) *
                                     std::tan(std::min(theta_i, theta_o));
        test::expect_near(f(material, wi, wo, {}).value, material.albedo / pi * shape, 1e-10);
    }
}

/// int max(0, cos dphi) dphi = 2, so M / E = A + (2B/pi) [int over theta_i of sin(alpha) tan(beta)
/// cos sin] = A + (2B/pi) [sin_o int_0^o sin^2 + tan_o int_o^(pi/2) sin^2 cos].
TEST(OrenNayar, HasTheAlbedoThatItsIntegralGives)
{
    for (const double sigma : {0.1, 0.5, 0.5 * pi}) {
        for (const double theta : {0.0, 0.4, 1.0, 1.5}) {
            const OrenNayar material{{0.2, 0.6, 1.0}, false, sigma};
            const Vec3 wo{std::sin(theta), 0.0, std::cos(theta)};
            const double A = test::term(terms(material, wo, wo, {}), "A").r;
            const double B = test::term(terms(material, wo, wo, {}), "B").r;
            const double nearer = 0.5 * theta - 0.25 * std::sin(2.0 * theta);
            const double farther = (1.0 - std::pow(std::sin(theta), 3)) / 3.0;
            const double expected =
                A + 2.0 * B / pi * (std::sin(theta) * nearer + std::tan(theta) * farther);
            const Rgb share = test::albedo(material, wo, 100);
            EXPECT_NEAR(share.b, expected, 5e-4);  // max(0, cos) has a corner
            EXPECT_NEAR(share.r, 0.2 * expected, 1e-4);
            EXPECT_LE(share.b, 1.016);
        }
    }
}

TEST(OrenNayar, ShowsMostOfItsLitFacetsToTheLight)  // a full moon is flat: no darker at its rim
{
    const OrenNayar moon{Rgb::grey(1.0), false, 0.7};
    const auto radiance = [&](double theta, double turn) {
        const Vec3 wi{std::sin(theta), 0.0, std::cos(theta)};
        return f(moon, wi, test::direction(wi.z, turn), {}).value.g * wi.z;
    };
    EXPECT_GT(radiance(1.0, 0.0), 1.5 * radiance(1.0, pi));
    const double rim = radiance(1.0, 0.0) / radiance(0.0, 0.0);
    EXPECT_GT(rim, 1.5 * std::cos(1.0));  // Lambert's rim is cos(1)
}

}  // namespace
}  // namespace relight
