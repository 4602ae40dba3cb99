#include <gtest/gtest.h>

#include "core/bsdf/beckmann.h"
#include "core/bsdf/ggx.h"
#include "core/bsdf/gtr.h"
#include "core/bsdf/smith.h"
#include "tests/bsdf/quadrature.h"

namespace relight {
namespace {

constexpr double cosines[] = {1e-4, 0.02, 0.1, 0.4, 0.8, 0.99};

TEST(G1, ConservesTheProjectedArea)  // cos(w) = G1 int (w.m)+ D dm
{
    for (const double a : {1e-3, 0.05, 0.3, 1.0}) {
        for (const double c : cosines) {
            SCOPED_TRACE(testing::Message() << "alpha = " << a << ", cos = " << c);
            const Vec3 w = test::direction(c, 0.6);
            const double ggx_hidden =
                test::hidden_area([&](Vec3 m) { return ggx::D(m.z, a); }, w, a);
            EXPECT_NEAR(smith::G1(c, ggx::Lambda_cos(w, a, a)), c / (c + ggx_hidden), 1e-6);
            const double gauss_hidden =
                test::hidden_area([&](Vec3 m) { return beckmann::D(m, a, a); }, w, a);
            EXPECT_NEAR(smith::G1(c, beckmann::Lambda_cos(w, a, a)), c / (c + gauss_hidden), 1e-6);
        }
    }
}

TEST(G1, ConservesTheProjectedAreaWhenTheWidthsDiffer)
{
    const double ax = 0.1, ay = 0.6;
    for (const double c : {0.05, 0.5}) {
        for (const double phi : {0.0, 0.5, 1.57}) {
            SCOPED_TRACE(testing::Message() << "cos = " << c << ", phi = " << phi);
            const Vec3 w = test::direction(c, phi);
            const double ggx_hidden =
                test::hidden_area([&](Vec3 m) { return ggx::D(m, ax, ay); }, w, ax);
            EXPECT_NEAR(smith::G1(c, ggx::Lambda_cos(w, ax, ay)), c / (c + ggx_hidden), 1e-6);
            const double gauss_hidden =
                test::hidden_area([&](Vec3 m) { return beckmann::D(m, ax, ay); }, w, ax);
            EXPECT_NEAR(smith::G1(c, beckmann::Lambda_cos(w, ax, ay)), c / (c + gauss_hidden),
                        1e-6);
        }
    }
}

TEST(Gtr, MaskingIsTheIntegralOfItsDistribution)
{
    for (const auto& [a, g] : {std::pair{1e-3, 0.5},
                               {1e-3, 1.5},
                               {0.02, 10.0},
                               {0.1, 1.0},
                               {0.5, 0.2},
                               {0.5, 3.0},
                               {1.0, 5.0}}) {
        const gtr::Masking masking(a, g);
        for (const double c : cosines) {
            SCOPED_TRACE(testing::Message() << "alpha " << a << ", gamma " << g << ", cos " << c);
            const Vec3 w = test::direction(c, 0.6);
            const double hidden = test::hidden_area(
                [&, alpha = a, gamma = g](Vec3 m) { return gtr::D(m.z, alpha, gamma); }, w, a);
            EXPECT_NEAR(smith::G1(c, masking.Lambda_cos(w)), c / (c + hidden), 1e-6);
        }
    }
}

TEST(Gtr, MaskingOfExponentTwoIsGgxs)
{
    for (const double a : {1e-3, 2e-3, 0.05, 0.4, 0.999, 1.0}) {
        const gtr::Masking masking(a, 2.0);
        for (int i = 0; i <= 2000; ++i) {  // crowded toward grazing
            const double c = 1e-6 + (1.0 - 1e-6) * std::pow(i / 2000.0, 3);
            const Vec3 w = test::direction(c, -2.0);
            const double expected = ggx::Lambda_cos(w, a, a);
            EXPECT_NEAR(masking.Lambda_cos(w), expected, 1e-6 * expected) << a << ' ' << c;
        }
    }
}

TEST(G1, IsOneFromAboveFallsTowardTheHorizonAndIsZeroBelow)
{
    const gtr::Masking masking(0.3, 1.3);
    const auto falls = [](auto Lambda_cos) {
        double before = smith::G1(1.0, Lambda_cos(Vec3{0, 0, 1}));
        EXPECT_EQ(before, 1.0);
        for (int i = 1; i < 1000; ++i) {
            const double c = 1.0 - 0.001 * i;
            const double now = smith::G1(c, Lambda_cos(test::direction(c, 1.0)));
            EXPECT_LE(now, before) << c;
            before = now;
        }
        EXPECT_LT(smith::G1(1e-9, Lambda_cos(test::direction(1e-9, 1.0))), 1e-6);
        EXPECT_EQ(smith::G1(-0.5, Lambda_cos(test::direction(0.5, 1.0))), 0.0);
        EXPECT_EQ(smith::G1(0.0, Lambda_cos(test::direction(0.0, 1.0))), 0.0);
    };
    falls([](Vec3 w) { return ggx::Lambda_cos(w, 0.4, 0.4); });
    falls([](Vec3 w) { return beckmann::Lambda_cos(w, 0.4, 0.4); });
    falls([&](Vec3 w) { return masking.Lambda_cos(w); });
}

TEST(G2, CorrelatedIsNeverLessThanSeparable)
{
    for (const double a : {0.01, 0.3, 1.0}) {
        for (int i = 0; i < 27; ++i) {
            for (int j = 0; j < 25; ++j) {
                const double ci = 1e-3 + 0.037 * i, co = 1e-3 + 0.041 * j;
                const double Li = ggx::Lambda_cos(test::direction(ci, 0), a, a);
                const double Lo = ggx::Lambda_cos(test::direction(co, 1), a, a);
                const double correlated = smith::V_height_correlated(ci, Li, co, Lo);
                EXPECT_GE(correlated * (1 + 1e-14), smith::V_separable(ci, Li, co, Lo));
                // G2 = V 4 cos cos is a share of facets, at most what one direction alone sees.
                const double G2 = correlated * 4.0 * ci * co;
                EXPECT_LE(G2, std::min(smith::G1(ci, Li), smith::G1(co, Lo)) * (1 + 1e-14));
                EXPECT_NEAR(1.0 / G2, 1.0 + Li / ci + Lo / co, 1e-12 / G2);  // as printed
            }
        }
    }
}

TEST(G2, OfGgxIsItsTextbookForm)  // 1/2 / (co sqrt(a2 + (1-a2) ci2) + ci sqrt(a2 + (1-a2) co2))
{
    const double a2 = 0.09;
    for (const double ci : {0.01, 0.5, 1.0}) {
        for (const double co : {0.02, 0.7}) {
            const double expected = 0.5 / (co * std::sqrt(a2 + (1 - a2) * ci * ci) +
                                           ci * std::sqrt(a2 + (1 - a2) * co * co));
            const double V =
                smith::V_height_correlated(ci, ggx::Lambda_cos(test::direction(ci, 0), 0.3, 0.3),
                                           co, ggx::Lambda_cos(test::direction(co, 2), 0.3, 0.3));
            EXPECT_NEAR(V / expected, 1.0, 1e-12);
        }
    }
}

}  // namespace
}  // namespace relight
