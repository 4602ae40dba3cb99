#include "core/light/sky.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/light/light.h"
#include "tests/chi2.h"
#include "tests/light/monte_carlo.h"

namespace relight {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double degree = pi / 180.0;
const Dir3 up = normalize({0, 1, 0});

Dir3 sun_at(double altitude_deg, double azimuth_deg = 180.0)  // clockwise from north
{
    const double h = altitude_deg * degree, a = azimuth_deg * degree;
    return normalize({std::cos(h) * std::sin(a), std::sin(h), -std::cos(h) * std::cos(a)});
}

/// The model's distributions, written again as the paper's tables: rows A to E, in T and 1.
using Fit = std::array<std::array<double, 2>, 5>;
constexpr Fit of_luminance{{{0.1787, -1.4630},
                            {-0.3554, 0.4275},
                            {-0.0227, 5.3251},
                            {0.1206, -2.5771},
                            {-0.0670, 0.3703}}};
constexpr Fit of_x{{{-0.0193, -0.2592},
                    {-0.0665, 0.0008},
                    {-0.0004, 0.2125},
                    {-0.0641, -0.8989},
                    {-0.0033, 0.0452}}};
constexpr Fit of_y{{{-0.0167, -0.2608},
                    {-0.0950, 0.0092},
                    {-0.0079, 0.2102},
                    {-0.0441, -1.6537},
                    {-0.0109, 0.0529}}};

/// A quantity of the sky relative to the zenith's.
double relative(const Fit& fit, double T, double theta_s, double cos_theta, double gamma)
{
    const auto F = [&](double cosine, double g) {
        const auto c = [&](std::size_t row) { return fit[row][0] * T + fit[row][1]; };
        return (1.0 + c(0) * std::exp(c(1) / cosine)) *
               (1.0 + c(2) * std::exp(c(3) * g) + c(4) * std::pow(std::cos(g), 2));
    };
    return F(cos_theta, gamma) / F(1.0, theta_s);
}

/// Luminance in kcd/m^2.
double preetham(double T, double theta_s, double cos_theta, double gamma)
{
    const double chi = (4.0 / 9.0 - T / 120.0) * (pi - 2.0 * theta_s);
    const double zenith = (4.0453 * T - 4.9710) * std::tan(chi) - 0.2155 * T + 2.4192;
    return zenith * relative(of_luminance, T, theta_s, cos_theta, gamma);
}

/// Chromaticity of the zenith: (T^2 T 1) m (theta^3 theta^2 theta 1).
double at_zenith(const std::array<std::array<double, 4>, 3>& m, double T, double theta_s)
{
    double sum = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
            sum += std::pow(T, 2.0 - static_cast<double>(i)) * m[i][j] *
                   std::pow(theta_s, 3.0 - static_cast<double>(j));
        }
    }
    return sum;
}

/// E of the model's dome at n [lx], by midpoints in (y, phi).
double model_irradiance(double T, Dir3 toward_sun, Dir3 n)
{
    constexpr int rows = 300, columns = 600;
    const double theta_s = std::acos(toward_sun.y());
    double sum = 0.0;
    for (int i = 0; i < rows; ++i) {
        const double y = (i + 0.5) / rows, sine = std::sqrt(1.0 - y * y);
        for (int j = 0; j < columns; ++j) {
            const double phi = 2.0 * pi * (j + 0.5) / columns;
            const Vec3 w{sine * std::cos(phi), y, sine * std::sin(phi)};
            const double cosine = dot(w, n);
            if (cosine <= 0.0) { continue; }
            const double gamma = std::acos(std::min(1.0, dot(w, toward_sun)));
            sum += cosine * preetham(T, theta_s, y, gamma);
        }
    }
    return 1000.0 * sum * 2.0 * pi / (rows * columns);
}

double dome_irradiance(const SkyLight& sky, Dir3 n)
{
    const Image& image = sky.dome->image();
    double sum = 0.0;
    for (int row = 0; row < image.height; ++row) {
        const double theta = pi * (row + 0.5) / image.height;
        for (int column = 0; column < image.width; ++column) {
            const double phi = 2.0 * pi * ((column + 0.5) / image.width - 0.5);
            const Vec3 w{std::sin(theta) * std::cos(phi), std::cos(theta),
                         std::sin(theta) * std::sin(phi)};
            sum += std::max(0.0, dot(w, n)) * sky.dome->texel_solid_angle(row) *
                   luminance(sky.dome->radiance(w));
        }
    }
    return sum;
}

TEST(Sky, TheDomesTableKeepsItsIlluminance)
{
    for (const double T : {2.0, 3.0, 6.0, 10.0}) {
        for (const double altitude : {0.5, 10.0, 45.0, 90.0}) {
            const Dir3 sun = sun_at(altitude, 130.0);
            const SkyLight sky = make_sky(sun, T);
            for (const Vec3& n : {Vec3{0, 1, 0}, Vec3{1, 1, 1}}) {
                EXPECT_NEAR(
                    dome_irradiance(sky, normalize(n)) / model_irradiance(T, sun, normalize(n)),
                    1.0, 0.005)
                    << T << ' ' << altitude;
            }
        }
    }
}

TEST(Sky, HasTheModelsColourEverywhere)
{
    for (const double T : {2.0, 3.0, 6.0}) {
        for (const double altitude : {10.0, 50.0}) {
            const Dir3 toward = sun_at(altitude);
            const SkyLight sky = make_sky(toward, T);
            const Image& image = sky.dome->image();
            const double theta_s = std::acos(toward.y());
            const double x_zenith = at_zenith({{{0.00166, -0.00375, 0.00209, 0.0},
                                                {-0.02903, 0.06377, -0.03202, 0.00394},
                                                {0.11693, -0.21196, 0.06052, 0.25886}}},
                                              T, theta_s);
            const double y_zenith = at_zenith({{{0.00275, -0.00610, 0.00317, 0.0},
                                                {-0.04214, 0.08970, -0.04153, 0.00516},
                                                {0.15346, -0.26756, 0.06670, 0.26688}}},
                                              T, theta_s);
            for (int row = 0; row < image.height / 2; row += 9) {
                for (int column = 0; column < image.width; column += 31) {
                    const double theta = pi * (row + 0.5) / image.height;
                    const double phi = 2.0 * pi * ((column + 0.5) / image.width - 0.5);
                    const Vec3 w{std::sin(theta) * std::cos(phi), std::cos(theta),
                                 std::sin(theta) * std::sin(phi)};
                    const double gamma = std::acos(std::min(1.0, dot(w, toward)));
                    const double x = x_zenith * relative(of_x, T, theta_s, w.y, gamma);
                    const double y = y_zenith * relative(of_y, T, theta_s, w.y, gamma);
                    const Rgb L = sky.dome->radiance(w);
                    ASSERT_GT(std::min({L.r, L.g, L.b}), 0.0);  // in gamut: nothing was cut
                    // Rec.709 to XYZ, ITU-R BT.709.
                    const double X = 0.412391 * L.r + 0.357584 * L.g + 0.180481 * L.b;
                    const double Y = 0.212639 * L.r + 0.715169 * L.g + 0.072192 * L.b;
                    const double Z = 0.019331 * L.r + 0.119195 * L.g + 0.950532 * L.b;
                    EXPECT_NEAR(X / (X + Y + Z), x, 1e-5);
                    EXPECT_NEAR(Y / (X + Y + Z), y, 1e-5);
                    EXPECT_NEAR(Y / (1000.0 * preetham(T, theta_s, w.y, gamma)), 1.0, 1e-5);
                }
            }
        }
    }
}

TEST(Sky, AClearNoonHasTheSunAndSkyThatAreMeasured)
{
    for (const double T : {2.0, 2.5, 3.0}) {
        const SkyLight sky = make_sky(sun_at(45.0), T);
        const double sun = luminance(sky.sun_E_perp), diffuse = dome_irradiance(sky, up);
        EXPECT_TRUE(sun > 80e3 && sun < 110e3) << sun;
        EXPECT_TRUE(diffuse > 5e3 && diffuse < 30e3) << diffuse;
    }
}

TEST(Sky, IsBlueAwayFromTheSunAndPalerAtTheHorizon)
{
    const SkyLight sky = make_sky(sun_at(40.0), 2.5);
    const Rgb zenith = sky.dome->radiance(up);
    const Rgb horizon = sky.dome->radiance(normalize({1, 0.03, 0}));
    EXPECT_GT(zenith.b, 1.5 * zenith.r);
    EXPECT_GT(zenith.b, zenith.g);
    EXPECT_LT(horizon.b / horizon.r, 0.8 * zenith.b / zenith.r);
}

TEST(Sky, TheSunDimsAndReddensAsItSinksAndAsTheAirThickens)
{
    double brightest = 200e3, reddest = 0.0;
    for (const double altitude : {90.0, 60.0, 30.0, 15.0, 8.0, 4.0, 2.0, 1.0}) {
        const Rgb E = make_sky(sun_at(altitude), 3.0).sun_E_perp;
        EXPECT_LT(luminance(E), brightest) << altitude;
        EXPECT_GT(E.r / E.b, reddest) << altitude;
        brightest = luminance(E);
        reddest = E.r / E.b;
    }
    double last = 200e3;
    for (const double T : {2.0, 3.0, 5.0, 7.0, 10.0}) {
        const double E = luminance(make_sky(sun_at(30.0), T).sun_E_perp);
        EXPECT_LT(E, last);
        last = E;
    }
}

TEST(Sky, NothingJumpsWhileTheSunSets)
{
    const auto light_at = [](double altitude) {
        const SkyLight sky = make_sky(sun_at(altitude), 3.0);
        return std::array{dome_irradiance(sky, up), luminance(sky.sun_E_perp)};
    };
    double last = 1e9;
    for (const double altitude : {0.5, 0.2665, 0.1, 0.0, -0.1, -0.2665, -3.0, -6.0, -12.0, -17.9}) {
        const auto here = light_at(altitude), above = light_at(altitude + 1e-5);
        EXPECT_NEAR(here[0] / above[0], 1.0, 1e-3) << altitude;
        EXPECT_NEAR(here[1], above[1], 0.01) << altitude;
        EXPECT_LT(here[0], last) << altitude;
        EXPECT_GT(here[0], 0.0) << altitude;
        EXPECT_EQ(here[1] > 0.0, altitude > -0.2665) << altitude;  // while any of it is seen
        last = here[0];
    }
    // A hundredth or two of a per cent of it is left where nautical twilight ends.
    EXPECT_NEAR(light_at(-12.0)[0] / light_at(0.0)[0], 1.6e-5, 1e-5);
    for (const double altitude : {-18.0, -30.0, -90.0}) {
        const SkyLight sky = make_sky(sun_at(altitude), 3.0);
        EXPECT_EQ(sky.dome->luminance_integral(), 0.0);
        EXPECT_EQ(sky.sun_E_perp, Rgb{});
        EXPECT_FALSE(sample(sky, {0.4, 0.6}, 0.2).wi);
        EXPECT_FALSE(sample(sky, {0.4, 0.6}, 0.8).wi);
    }
}

TEST(Sky, IsFiniteNotNegativeAndDarkBelowTheHorizon)
{
    for (const double T : {least_turbidity, 4.0, 6.0, 8.0, largest_turbidity}) {
        for (const double altitude : {-90.0, -5.0, 0.0, 0.01, 3.0, 30.0, 60.0, 89.999, 90.0}) {
            const SkyLight sky = make_sky(sun_at(altitude, 77.0), T);
            const Image& image = sky.dome->image();
            for (int i = 0; i < image.width * image.height; ++i) {
                const Rgb L = to_double(image.pixels[static_cast<std::size_t>(i)]);
                ASSERT_TRUE(std::isfinite(luminance(L)) && L.r >= 0.0 && L.g >= 0.0 && L.b >= 0.0);
                if (i / image.width >= image.height / 2) {
                    ASSERT_EQ(L, Rgb{});
                } else if (altitude >= 0.0) {
                    ASSERT_GT(luminance(L), 0.0);
                }
            }
            EXPECT_TRUE(std::isfinite(luminance(sky.sun_E_perp)));
        }
    }
    EXPECT_TRUE(std::isfinite(make_sky({}, 3.0).dome->luminance_integral()));
}

TEST(Sky, TurnsWithTheSun)
{
    // A quarter turn maps texels onto texels.
    const SkyLight south = make_sky(sun_at(35.0, 180.0), 3.0);
    const SkyLight west = make_sky(sun_at(35.0, 270.0), 3.0);
    EXPECT_EQ(south.sun_E_perp, west.sun_E_perp);
    for (int i = 0; i < 1000; ++i) {
        const Sample2 s = test::draw(1, i).s;
        const Vec3 w = normalize({s.u - 0.5, 0.3 * s.v + 0.01, 0.123});
        const Vec3 turned{-w.z, w.y, w.x};  // clockwise seen from above: +Z (south) to -X (west)
        const double a = luminance(south.dome->radiance(w));
        EXPECT_NEAR(luminance(west.dome->radiance(turned)) / a, 1.0, 1e-5);
    }
}

TEST(Sky, ItsSamplesGiveTheIrradianceOfDomeAndSun)
{
    std::uint64_t seed = 50;
    test::Offsets offsets;
    for (const double altitude : {-4.0, 3.0, 40.0}) {
        const SkyLight sky = make_sky(sun_at(altitude, 150.0), 3.0);
        for (const Vec3& normal : {Vec3{0, 1, 0}, Vec3{0.3, 0.2, 1}, Vec3{-1, -0.2, 0}}) {
            const Dir3 n = normalize(normal);
            const double E =
                dome_irradiance(sky, n) + luminance(sky.sun_E_perp) * irradiance(sky.sun, n);
            const test::Estimate estimate = test::irradiance_by_samples(
                [&](test::Draw d) { return sample(sky, d.s, d.pick); }, n, 40000, ++seed);
            EXPECT_LE(std::abs(estimate.mean - E), 4.0 * estimate.standard_error + 1e-4 * E)
                << estimate.off(E);
            offsets.add(estimate.off(E));
        }
    }
    EXPECT_LT(offsets.rms(), 1.7);  // of 9 alone
}

TEST(Sky, HalfOfTheSamplesAreTheSuns)
{
    const SkyLight sky = make_sky(sun_at(40.0, 120.0), 4.0);
    constexpr int samples = 100000;
    int in_disc = 0;
    for (int i = 0; i < samples; ++i) {
        const test::Draw d = test::draw(9, i);
        in_disc += dot(sample(sky, d.s, d.pick).wi, -sky.sun.travel) >
                   std::cos(1.001 * sky.sun.half_angle);
    }
    EXPECT_NEAR(in_disc, 0.5 * samples, 4.0 * std::sqrt(0.25 * samples) + 1e-3 * samples);
}

TEST(Sky, IsDrawnFromTheMixtureItClaims)
{
    // Texels and a sun at the zenith whose edges are the bins' own.
    Image image{16, 2, {}, {}};
    for (const double L : {1, 5, 0, 2, 3, 3, 3, 9, 1, 1, 0, 0, 4, 2, 1, 7}) {
        image.pixels.push_back(to_float(Rgb::grey(L)));
    }
    image.pixels.resize(32);
    const SkyLight sky{std::make_shared<const EnvironmentMap>(image),
                       {normalize({0, -1, 0}), std::acos(0.75)},
                       {3.0, 2.0, 1.0}};
    const auto swapped = [](Vec3 w) { return Vec3{w.x, w.z, w.y}; };  // +Y to the bins' axis
    const test::Chi2 result = test::chi2_directions(
        [&](int i) {
            const test::Draw d = test::draw(9, i);
            return swapped(sample(sky, d.s, d.pick).wi);
        },
        [&](Vec3 w) { return look(sky, normalize(swapped(w))).pdf; }, 100000);
    EXPECT_GT(result.p, 1e-3) << result.statistic << " of " << result.degrees;
    EXPECT_NEAR(result.integral, 1.0, 1e-6);
}

TEST(Sky, ALookInsideTheDiscSeesDomeAndSunAndOutsideTheDomeAlone)
{
    const SkyLight sky = make_sky(sun_at(40.0, 120.0), 3.0);
    const Dir3 middle = -sky.sun.travel;
    const double sine = std::sin(sky.sun.half_angle);
    const double disc = luminance(sky.sun_E_perp) / (pi * sine * sine);
    const LightSample seen = look(sky, middle);
    EXPECT_NEAR(luminance(seen.L) / (disc + luminance(sky.dome->radiance(middle))), 1.0, 1e-9);
    EXPECT_GT(seen.pdf, 0.49 / (pi * sine * sine));
    const Frame frame = frame_around(middle);
    const Dir3 beside =
        normalize(Vec3(middle) + Vec3(frame.x) * std::tan(1.1 * sky.sun.half_angle));
    EXPECT_EQ(look(sky, beside).L, sky.dome->radiance(beside));
    EXPECT_NEAR(look(sky, beside).pdf / (0.5 * sky.dome->pdf(beside)), 1.0, 1e-12);
    EXPECT_EQ(look(sky, normalize({0.3, -1, 0})).L, Rgb{});
    for (int i = 0; i < 2000; ++i) {
        const test::Draw d = test::draw(10, i);
        const LightSample drawn = sample(sky, d.s, d.pick), again = look(sky, drawn.wi);
        EXPECT_NEAR(drawn.pdf / again.pdf, 1.0, 1e-9);
        EXPECT_NEAR(luminance(drawn.L) / luminance(again.L), 1.0, 1e-9);
    }
}

TEST(Sky, OnePartAloneTakesAllSamples)
{
    SkyLight dome_only = make_sky(sun_at(-3.0), 3.0);
    const LightSample drawn = sample(dome_only, {0.2, 0.7}, 0.1);
    EXPECT_NEAR(drawn.pdf / dome_only.dome->pdf(drawn.wi), 1.0, 1e-12);
    SkyLight sun_only = make_sky(sun_at(30.0), 3.0);
    sun_only.dome = nullptr;
    const LightSample disc = sample(sun_only, {0.2, 0.7}, 0.9);
    EXPECT_NEAR(disc.pdf / sample(sun_only.sun, {0.2, 0.7}).pdf, 1.0, 1e-12);
    EXPECT_FALSE(sample(SkyLight{}, {0.2, 0.7}, 0.9).wi);
}

}  // namespace
}  // namespace relight
