#include "core/bsdf/lambert.h"

#include <gtest/gtest.h>

#include "core/bsdf/material.h"
#include "tests/bsdf/quadrature.h"

namespace relight {
namespace {

constexpr double pi = std::numbers::pi;
const Vec3 up{0.0, 0.0, 1.0};

/// Integral of g(cosine) over the hemisphere of directions.
template <class G>
double over_hemisphere(G g)
{
    return 2.0 * pi * test::over_interval(g, 0.0, 1.0, 4);
}

TEST(Hemisphere, HasTwoPiOfSolidAngleAndPiOfItProjected)
{
    EXPECT_NEAR(over_hemisphere([](double) { return 1.0; }), 2.0 * pi, 1e-9);
    EXPECT_NEAR(over_hemisphere([](double c) { return c; }), pi, 1e-9);
}

TEST(Lambert, ReflectsItsAlbedo)
{
    const Rgb rho{0.2, 0.5, 1.0};
    const Lambert white{rho};
    for (const double cos_i : {1.0, 0.3}) {  // M / E for light from one direction
        const auto M = [&](double c) {
            return f(white, test::direction(cos_i, 0.0), test::direction(c, 2.0), {}).value.g * c;
        };
        EXPECT_NEAR(over_hemisphere(M), rho.g, 1e-9);
    }
}

TEST(Lambert, OfAlbedoOneShowsAUniformSkysOwnRadiance)
{
    const Lambert white{Rgb::grey(1.0)};
    const double L = 7.0;
    const auto reflected = [&](double c) {
        return f(white, test::direction(c, 1.0), test::direction(0.6, 0.0), {}).value.r * L * c;
    };
    EXPECT_NEAR(over_hemisphere(reflected), L, 1e-9 * L);
}

TEST(Lambert, TakesTheVertexColourOnlyWhenToldTo)
{
    const Rgb vertex{0.1, 0.2, 0.3};
    EXPECT_EQ(f(Lambert{Rgb::grey(0.8), true}, up, up, vertex).value, vertex / pi);
    EXPECT_EQ(f(Lambert{Rgb::grey(0.8), false}, up, up, vertex).value, Rgb::grey(0.8) / pi);
}

TEST(Lambert, IsDarkFromBelow)
{
    const Lambert white{};
    EXPECT_EQ(f(white, -up, up, {}), BsdfValue{});
    EXPECT_EQ(f(white, up, -up, {}), BsdfValue{});
    EXPECT_EQ(f(white, Vec3{1, 0, 0}, up, {}), BsdfValue{});
}

TEST(Material, IsWhicheverModelItHolds)
{
    const CookTorrance rough = make_cook_torrance({});
    const Vec3 wi = test::direction(0.4, 0.3), wo = test::direction(0.8, 2.0);
    EXPECT_EQ(f(Material{Lambert{}}, wi, wo, {}), f(Lambert{}, wi, wo, {}));
    EXPECT_EQ(f(Material{rough}, wi, wo, {}), f(rough, wi, wo, {}));
}

}  // namespace
}  // namespace relight
