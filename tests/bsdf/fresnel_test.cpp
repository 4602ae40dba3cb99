#include "core/bsdf/fresnel.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/bsdf/quadrature.h"

namespace relight::fresnel {
namespace {

double square(double x)
{
    return x * x;
}

TEST(Fresnel, AtNormalIncidenceIsTheIndexContrast)
{
    for (const double eta : {1.0, 1.33, 1.5, 2.4, 0.6, 10.0}) {
        EXPECT_NEAR(dielectric(eta, 1.0), square((eta - 1.0) / (eta + 1.0)), 1e-12);
    }
    for (const auto& [n, k] : {std::pair{0.2, 3.9}, {1.5, 0.0}, {2.9, 3.1}, {1.0, 1.0}}) {
        EXPECT_NEAR(conductor(n, k, 1.0), (square(n - 1) + k * k) / (square(n + 1) + k * k), 1e-12);
    }
    EXPECT_DOUBLE_EQ(schlick(0.04, 1.0), 0.04);
}

TEST(Fresnel, IsOneAtGrazing)
{
    EXPECT_DOUBLE_EQ(schlick(0.04, 0.0), 1.0);
    EXPECT_DOUBLE_EQ(schlick(0.04, 0.0, 0.7), 0.7);
    for (const double eta : {1.33, 1.5, 2.4, 0.7}) {
        EXPECT_DOUBLE_EQ(dielectric(eta, 0.0), 1.0);
        EXPECT_NEAR(dielectric(eta, 1e-6), 1.0, 1e-4);
    }
    for (const auto& [n, k] : {std::pair{0.2, 3.9}, {2.9, 3.1}, {1.5, 0.0}}) {
        EXPECT_DOUBLE_EQ(conductor(n, k, 0.0), 1.0);
        EXPECT_NEAR(conductor(n, k, 1e-6), 1.0, 1e-4);
    }
}

TEST(Fresnel, OfAConductorThatAbsorbsNothingIsTheDielectrics)
{
    for (const double eta : {1.1, 1.5, 3.0, 0.6}) {
        for (int i = 0; i <= 1000; ++i) {
            EXPECT_NEAR(conductor(eta, 0.0, i / 1000.0), dielectric(eta, i / 1000.0), 1e-9) << eta;
        }
    }
}

TEST(Fresnel, AtBrewstersAngleReflectsOnlyOnePolarisation)
{
    for (const double eta : {1.33, 1.5, 2.4, 0.75}) {
        // There tan(theta) = eta, r_p = 0 and the refracted ray is square to the reflected one, so
        // r_s = (cos^2 - sin^2)/1 = (1 - eta^2)/(1 + eta^2).
        const double brewster = 1.0 / std::sqrt(1.0 + eta * eta);
        const double r_s = (1.0 - eta * eta) / (1.0 + eta * eta);
        EXPECT_NEAR(dielectric(eta, brewster), 0.5 * r_s * r_s, 1e-14);
        EXPECT_NEAR(conductor(eta, 0.0, brewster), 0.5 * r_s * r_s, 1e-14);
    }
}

TEST(Fresnel, IsTotalBeyondTheCriticalAngle)
{
    const double eta = 1.0 / 1.5;
    const double critical = std::sqrt(1.0 - eta * eta);
    EXPECT_EQ(dielectric(eta, critical - 1e-12), 1.0);
    EXPECT_EQ(dielectric(eta, 0.2), 1.0);
    EXPECT_LT(dielectric(eta, critical + 1e-6), 1.0);
}

TEST(Fresnel, IsTheSameFromBothSidesOfARefractedRay)
{
    for (const double u : {0.1, 0.5, 0.9}) {
        const double eta = 1.5;
        const double refracted = std::sqrt(1.0 - (1.0 - u * u) / (eta * eta));
        EXPECT_NEAR(dielectric(eta, u), dielectric(1.0 / eta, refracted), 1e-14);
    }
}

TEST(Fresnel, SchlicksMeanIsOnePlusTwentyF0OverTwentyOne)
{
    for (const double F0 : {0.0, 0.04, 0.5, 1.0}) {
        const auto F = [&](double u) { return 2.0 * schlick(F0, u) * u; };
        const double mean = test::over_interval(F, 0.0, 1.0, 8);
        EXPECT_NEAR(mean, (1.0 + 20.0 * F0) / 21.0, 1e-12);
        EXPECT_NEAR(schlick_mean(F0), mean, 1e-12);
    }
    const auto dimmer = [](double u) { return 2.0 * schlick(0.2, u, 0.6) * u; };
    EXPECT_NEAR(schlick_mean(0.2, 0.6), test::over_interval(dimmer, 0.0, 1.0, 8), 1e-12);
}

TEST(Fresnel, StaysBetweenZeroAndOneForAnyInput)
{
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const auto share = [](double F) { return F >= 0.0 && F <= 1.0; };
    for (int i = 0; i < 100'000; ++i) {
        const double u =
            i % 3 == 0 ? std::pow(10.0, -300.0 * unit(random)) : 1.4 * unit(random) - 0.2;
        const double n = std::pow(10.0, 8.0 * unit(random) - 4.0);
        const double k = i % 2 == 0 ? 0.0 : std::pow(10.0, 8.0 * unit(random) - 4.0);
        ASSERT_TRUE(share(dielectric(n, u))) << n << ' ' << u;
        ASSERT_TRUE(share(conductor(n, k, u))) << n << ' ' << k << ' ' << u;
        ASSERT_TRUE(share(schlick(unit(random), u)));
    }
    for (const double extreme : {0.0, 1e-300, 1.0, 1e200}) {
        for (const double u : {0.0, 1e-300, 0.5, 1.0}) {
            ASSERT_TRUE(share(dielectric(extreme, u))) << extreme << ' ' << u;
            ASSERT_TRUE(share(conductor(extreme, 0.0, u))) << extreme << ' ' << u;
            ASSERT_TRUE(share(conductor(0.0, extreme, u))) << extreme << ' ' << u;
            ASSERT_TRUE(share(conductor(extreme, extreme, u))) << extreme << ' ' << u;
        }
    }
}

}  // namespace
}  // namespace relight::fresnel
