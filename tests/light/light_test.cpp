#include "core/light/light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

namespace relight {
namespace {

constexpr double pi = std::numbers::pi;
const RadiantIntensity unit_intensity{Rgb::grey(1.0)};

/// Integral over the sphere of directions w of g(w): midpoints in cos(theta), equal steps in phi.
template <class G>
double over_sphere(G g)
{
    constexpr int rows = 2000, columns = 64;
    double sum = 0.0;
    for (int i = 0; i < rows; ++i) {
        const double z = -1.0 + 2.0 * (i + 0.5) / rows;
        const double s = std::sqrt(1.0 - z * z);
        for (int j = 0; j < columns; ++j) {
            const double phi = 2.0 * pi * (j + 0.5) / columns;
            sum += g(normalize({s * std::cos(phi), s * std::sin(phi), z}));
        }
    }
    return sum * 4.0 * pi / (rows * columns);
}

TEST(PointLight, SendsAllItsFluxThroughAnySphereAroundIt)
{
    const PointLight light{{0.3, -0.2, 0.1}, {}};
    const RadiantFlux Phi{{40.0, 20.0, 10.0}};
    const RadiantIntensity I = intensity_of_flux(light, Phi);
    for (const double R : {0.7, 3.0, 50.0}) {  // spheres around the origin: the light is off centre
        const double through = R * R * over_sphere([&](Dir3 w) {
                                   return irradiance(light, I, Point3{} + R * Vec3(w), -w).value.r;
                               });
        EXPECT_NEAR(through / Phi.value.r, 1.0, 1e-4) << "R = " << R;
    }
}

TEST(PointLight, FallsWithTheSquareOfAllLengths)
{
    const Point3 p{1.0, 2.0, -0.5};
    const Dir3 n = normalize({0.2, -0.3, 1.0});
    const Vec3 away{0.4, -1.0, 2.0};
    const double E = irradiance({p + away, 5.0}, unit_intensity, p, n).value.r;
    ASSERT_GT(E, 0.0);
    for (const double k : {1e-3, 0.5, 7.0, 1e5}) {
        const Point3 pk = Point3{} + k * (p - Point3{});
        const PointLight light{pk + k * away, 5.0 * k};
        EXPECT_NEAR(irradiance(light, unit_intensity, pk, n).value.r * k * k / E, 1.0, 1e-12);
    }
}

TEST(PointLight, GivesExactlyTwiceForTwiceTheFlux)
{
    const PointLight light{{1.0, 2.0, 3.0}, {}};
    const auto E = [&](double Phi) {
        return irradiance(light, intensity_of_flux(light, {Rgb::grey(Phi)}), {},
                          normalize({0, 1, 1}))
            .value.g;
    };
    EXPECT_EQ(E(2.0 * 13.7), 2.0 * E(13.7));
}

TEST(PointLight, GivesNothingFromBehindOrAtTheReceiver)
{
    const PointLight light{{0.0, 0.0, 1.0}, {}};
    EXPECT_EQ(irradiance(light, unit_intensity, {}, normalize({0, 0, -1})), Irradiance{});
    EXPECT_EQ(irradiance(light, unit_intensity, {0, 0, 1}, normalize({0, 0, 1})), Irradiance{});
    EXPECT_EQ(arrive(light, {0, 0, 1}).per_unit, 0.0);
}

TEST(PointLight, GivesNothingAtItsRangeAndBeyond)
{
    const Dir3 up = normalize({0, 0, 1});
    const auto E = [&](double distance, std::optional<double> range) {
        return irradiance(PointLight{{0, 0, distance}, range}, unit_intensity, {}, up).value.r;
    };
    EXPECT_EQ(E(2.0, 2.0), 0.0);
    EXPECT_EQ(E(9.0, 2.0), 0.0);
    EXPECT_GT(E(1.999, 2.0), 0.0);
    EXPECT_NEAR(E(1.0, 2.0), E(1.0, {}) * 15.0 / 16.0, 1e-15);  // 1 - (1/2)^4
    EXPECT_NEAR(E(0.01, 2.0) / E(0.01, {}), 1.0, 1e-9);         // the window opens wide near by
}

TEST(SpotLight, FadesOutAtItsRangeAsAPointLightDoes)
{
    const Dir3 up = normalize({0, 0, 1}), down = normalize({0, 0, -1});
    for (const double distance : {0.5, 1.0, 1.999, 2.0, 9.0}) {
        const Point3 at{0, 0, distance};
        const SpotLight spot{at, down, 0.2, 0.5, 2.0};
        const double E = irradiance(PointLight{at, 2.0}, unit_intensity, {}, up).value.r;
        EXPECT_DOUBLE_EQ(irradiance(spot, unit_intensity, {}, up).value.r, E);
        EXPECT_DOUBLE_EQ(arrive(spot, {}).per_unit, E);
    }
}

TEST(SpotLight, IsAPointLightInsideTheInnerConeAndDarkOutsideTheOuter)
{
    const SpotLight spot{{0, 0, 2}, normalize({0, 0, -1}), 0.3, 0.6};
    const PointLight point{{0, 0, 2}, {}};
    const Dir3 up = normalize({0, 0, 1});
    for (int i = 0; i < 120; ++i) {
        const double angle = 0.01 * i;
        const Point3 p{2.0 * std::tan(angle), 0.0, 0.0};
        const double E_spot = irradiance(spot, unit_intensity, p, up).value.r;
        const double E_point = irradiance(point, unit_intensity, p, up).value.r;
        if (angle < 0.3 - 1e-9) { EXPECT_DOUBLE_EQ(E_spot, E_point) << angle; }
        if (angle > 0.3 + 1e-9) { EXPECT_LT(E_spot, E_point) << angle; }
        if (angle > 0.6 + 1e-9) { EXPECT_EQ(E_spot, 0.0) << angle; }
    }
}

TEST(SpotLight, FluxIsIntensityTimesSolidAngle)
{
    // Cones that meet, nearly meet, and are too narrow for the ramp to be climbed, besides usual
    // ones.
    for (const auto& [inner, outer] : {std::pair{0.0, pi / 4},
                                       {0.3, 0.6},
                                       {0.5, 0.5},
                                       {0.5, 0.501},
                                       {0.0, 0.02},
                                       {0.01, 0.03},
                                       {0.0, pi / 2},
                                       {1.5, pi / 2}}) {
        const SpotLight light{{}, normalize({0, 0, -1}), inner, outer};
        constexpr int steps = 400'000;  // midpoints in angle from the axis
        double Omega = 0.0;
        for (int i = 0; i < steps; ++i) {
            const double angle = outer * (i + 0.5) / steps;
            Omega += cone_falloff(light, std::cos(angle)) * 2.0 * pi * std::sin(angle);
        }
        Omega *= outer / steps;
        EXPECT_NEAR(emission_solid_angle(light) / Omega, 1.0, 1e-6) << inner << ' ' << outer;
    }
}

TEST(SpotLight, ThatIsClosedHasNoIntensityRatherThanAnInfiniteOne)
{
    const SpotLight closed{{}, normalize({0, 0, -1}), 0.0, 0.0};
    EXPECT_EQ(intensity_of_flux(closed, {Rgb::grey(10.0)}), RadiantIntensity{});
}

TEST(DirectionalLight, IsTheSameEverywhere)
{
    const DirectionalLight sun{normalize({1, -2, 0.5})};
    const Arrival here = arrive(sun, {});
    const Arrival there = arrive(sun, {1e9, -3e7, 12.0});
    EXPECT_EQ(here.wi, there.wi);
    EXPECT_EQ(here.per_unit, 1.0);
    EXPECT_EQ(there.per_unit, 1.0);
    EXPECT_TRUE(std::isinf(here.distance));
    EXPECT_DOUBLE_EQ(irradiance(sun, {Rgb::grey(3.0)}, -sun.travel).value.r, 3.0);
    EXPECT_EQ(irradiance(sun, {Rgb::grey(3.0)}, sun.travel).value.r, 0.0);
}

TEST(Arrival, TurnsWithTheWorld)
{
    // A rotation by 2 pi / 3 about (1, 1, 1) permutes the axes: exact, so results must be equal.
    const auto turn = [](Vec3 v) { return Vec3{v.z, v.x, v.y}; };
    const Point3 at{0.4, 3.0, -1.0}, p{-0.3, 0.2, 0.9};
    const Dir3 axis = normalize({0.1, -1.0, 0.4});
    const Arrival before = arrive(SpotLight{at, axis, 0.2, 0.9}, p);
    const Arrival after =
        arrive(SpotLight{Point3{} + turn(at - Point3{}), normalize(turn(axis)), 0.2, 0.9},
               Point3{} + turn(p - Point3{}));
    ASSERT_GT(before.per_unit, 0.0);
    EXPECT_NEAR(after.per_unit / before.per_unit, 1.0, 1e-12);
    EXPECT_NEAR(length(turn(before.wi) - Vec3(after.wi)), 0.0, 1e-15);
}

TEST(Arrival, OfAnyFiniteInputIsFiniteAndNotNegative)
{
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    std::uniform_int_distribution<int> exponent(-308, 308), choice(0, 3);
    const auto number = [&] {
        switch (choice(random)) {
            case 0:
                return 0.0;
            case 1:
                return unit(random);
            case 2:
                return unit(random) * std::pow(10.0, exponent(random));
            default:
                return choice(random) % 2 == 0 ? 1e-200 : -1e200;
        }
    };
    const auto point = [&] { return Point3{number(), number(), number()}; };
    const auto direction = [&] { return normalize(point() - Point3{}); };
    for (int i = 0; i < 200'000; ++i) {
        const Point3 p = point();
        const Point3 at = i % 2 == 0 ? point() : p + Vec3{1e-200 * unit(random), 0.0, number()};
        const Dir3 n = direction();
        const SpotLight spot{at, direction(), std::abs(number()), std::abs(number())};
        const PointLight lamp{at, std::abs(number())};
        for (const LightShape& shape :
             {LightShape{lamp}, LightShape{PointLight{at, {}}}, LightShape{spot},
              LightShape{DirectionalLight{direction()}}}) {
            const Arrival a = arrive(shape, p);
            ASSERT_TRUE(std::isfinite(a.per_unit)) << i;
            ASSERT_GE(a.per_unit, 0.0) << i;
            ASSERT_TRUE(is_finite(a.wi)) << i;
            if (a.per_unit > 0.0) { ASSERT_TRUE(is_finite(a.to_light)) << i; }
            ASSERT_TRUE(std::isfinite(static_cast<float>(a.per_unit))) << i;
        }
        for (const double E : {irradiance(lamp, unit_intensity, p, n).value.r,
                               irradiance(spot, unit_intensity, p, n).value.r,
                               intensity_of_flux(spot, {Rgb::grey(1.0)}).value.r}) {
            ASSERT_TRUE(std::isfinite(E)) << i;
            ASSERT_GE(E, 0.0) << i;
        }
    }
}

}  // namespace
}  // namespace relight
