#include <gtest/gtest.h>

#include "core/bsdf/beckmann.h"
#include "core/bsdf/ggx.h"
#include "core/bsdf/gtr.h"
#include "core/bsdf/roughness.h"
#include "tests/bsdf/quadrature.h"

namespace relight {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double alphas[] = {1e-3, 3e-3, 0.01, 0.05, 0.2, 0.5, 0.9, 0.999, 1.0};
constexpr double gammas[] = {0.2, 0.5, 0.999, 1.0, 1.0 + 1e-9, 1.5, 2.0, 3.0, 10.0};

/// int D (n.m) dm, the projected area of all facets.
template <class D>
double projected_area(D distribution, double scale, int turns)
{
    return test::over_facets([&](Vec3 m) { return distribution(m) * m.z; }, scale, turns);
}

TEST(D, IntegratesToOneOverTheProjectedHemisphere)  // Walter et al. 2007, sec. 3.1
{
    for (const double a : alphas) {
        SCOPED_TRACE(a);
        EXPECT_NEAR(projected_area([&](Vec3 m) { return ggx::D(m.z, a); }, a, 1), 1.0, 1e-6);
        EXPECT_NEAR(projected_area([&](Vec3 m) { return beckmann::D(m.z, a); }, a, 1), 1.0, 1e-6);
        for (const double g : gammas) {
            EXPECT_NEAR(projected_area([&](Vec3 m) { return gtr::D(m.z, a, g); }, a, 1), 1.0, 1e-6)
                << "gamma = " << g;
        }
    }
}

TEST(D, IntegratesToOneAlsoWhenItsWidthsDiffer)
{
    for (const auto& widths : {std::pair{0.05, 0.2}, {0.5, 0.1}, {1.0, 0.3}, {2e-3, 1e-3}}) {
        const double ax = widths.first, ay = widths.second;
        SCOPED_TRACE(ax);
        const double scale = std::min(ax, ay);
        EXPECT_NEAR(projected_area([&](Vec3 m) { return ggx::D(m, ax, ay); }, scale, 256), 1.0,
                    1e-6);
        EXPECT_NEAR(projected_area([&](Vec3 m) { return beckmann::D(m, ax, ay); }, scale, 256), 1.0,
                    1e-6);
    }
}

TEST(D, WithEqualWidthsIsTheIsotropicOne)
{
    for (const double a : alphas) {
        for (const double theta : {0.0, 1e-4, 0.01, 0.3, 1.0, 1.5}) {
            for (const double phi : {0.0, 0.7, 2.0}) {
                const Vec3 m = test::direction(std::cos(theta), phi);
                const double expected = ggx::D(m.z, a);
                EXPECT_NEAR(ggx::D(m, a, a), expected, 1e-8 * expected) << a << ' ' << theta;
                const double gauss = beckmann::D(m.z, a);
                EXPECT_NEAR(beckmann::D(m, a, a), gauss, 1e-7 * gauss) << a << ' ' << theta;
            }
        }
    }
}

TEST(D, IsUnboundedAtThePoleAndZeroFromBelow)
{
    for (const double a : alphas) {
        EXPECT_NEAR(ggx::D(1.0, a) * pi * a * a, 1.0, 1e-12);
        EXPECT_NEAR(beckmann::D(1.0, a) * pi * a * a, 1.0, 1e-12);
        for (const double below : {0.0, -1e-9, -1.0}) {
            EXPECT_EQ(ggx::D(below, a), 0.0);
            EXPECT_EQ(beckmann::D(below, a), 0.0);
            EXPECT_EQ(gtr::D(below, a, 1.0), 0.0);
            EXPECT_EQ(ggx::D(Vec3{0, 0.6, below}, a, a), 0.0);
        }
    }
}

TEST(D, IsFiniteAllTheWayToTheHorizon)
{
    for (const double a : alphas) {
        for (int i = 0; i <= 307; ++i) {
            const double c = std::pow(10.0, -i);
            ASSERT_TRUE(std::isfinite(beckmann::D(c, a))) << a << ' ' << c;
            ASSERT_TRUE(std::isfinite(beckmann::D(test::direction(c, 0.0), a, a))) << a << ' ' << c;
            ASSERT_TRUE(std::isfinite(ggx::D(c, a))) << a << ' ' << c;
            for (const double g : {1e-3, 1.0, 10.0, 1000.0}) {
                ASSERT_TRUE(std::isfinite(gtr::D(c, a, g))) << a << ' ' << c << ' ' << g;
            }
        }
    }
}

TEST(Gtr, OfExponentTwoIsGgx)
{
    for (const double a : alphas) {
        for (int i = 0; i < 157; ++i) {
            const double theta = 0.01 * i, c = std::cos(theta), expected = ggx::D(c, a);
            EXPECT_NEAR(gtr::D(c, a, 2.0), expected, 1e-12 * expected + 1e-12) << a << ' ' << theta;
        }
    }
}

TEST(Gtr, OfExponentOneIsDisneysClearCoat)  // Burley 2012: (a^2 - 1) / (pi ln a^2 (...))
{
    for (const double a : {1e-3, 0.1, 0.5, 0.9}) {
        for (const double c : {1.0, 0.999, 0.7, 0.1}) {
            const double x = a * a - 1.0;
            const double expected = x / (pi * std::log(a * a) * (1.0 + x * c * c));
            EXPECT_NEAR(gtr::D(c, a, 1.0), expected, 1e-8 * expected) << a << ' ' << c;
        }
    }
}

TEST(Gtr, IsTheLawAsPrintedForOtherExponents)
{
    for (const double g : {0.5, 1.5, 3.0, 10.0}) {
        for (const double a : {0.1, 0.5, 0.9}) {
            for (const double c : {1.0, 0.99, 0.5, 0.1}) {
                const double x = a * a - 1.0;
                const double k = (g - 1.0) * x / (pi * (1.0 - std::pow(a, 2.0 * (1.0 - g))));
                const double expected = k / std::pow(1.0 + x * c * c, g);
                EXPECT_NEAR(gtr::D(c, a, g), expected, 1e-9 * expected)
                    << g << ' ' << a << ' ' << c;
            }
        }
    }
}

TEST(Gtr, IsContinuousWhereItsFormulaIsNotDefined)
{
    for (const double c : {1.0, 0.8, 0.2}) {
        for (const double g : gammas) {
            EXPECT_NEAR(gtr::D(c, 1.0, g), 1.0 / pi,
                        1e-15);  // alpha = 1: every facet direction alike
            for (const double near : {1e-4, 1e-8, 1e-12, 1e-15}) {
                EXPECT_NEAR(gtr::D(c, 1.0 - near, g), 1.0 / pi, 1e-6 + 25.0 * near) << g;
            }
        }
        for (const double a : {1e-3, 0.1, 0.9}) {
            const double D1 = gtr::D(c, a, 1.0);
            for (const double near : {1e-7, -1e-7, 1e-10, -1e-15}) {
                EXPECT_NEAR(gtr::D(c, a, 1.0 + near), D1, 1e-5 * D1) << a << ' ' << near;
            }
        }
    }
}

TEST(Alpha, IsRoughnessSquaredButNeverBelowItsFloor)
{
    EXPECT_EQ(alpha_from_roughness(0.5), 0.25);
    EXPECT_EQ(alpha_from_roughness(1.0), 1.0);
    EXPECT_EQ(alpha_from_roughness(0.0), least_alpha);
    EXPECT_GT(least_alpha, 0.0);
}

}  // namespace
}  // namespace relight
