#include "core/light/environment.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <numbers>

#include "core/base/warp.h"
#include "core/light/cap.h"
#include "core/light/light.h"
#include "tests/chi2.h"
#include "tests/light/monte_carlo.h"
#include "tests/oracle.h"

namespace relight {
namespace {

using nlohmann::json;
using test::oracle;

constexpr double pi = std::numbers::pi;

Image image_of(int width, int height, const std::vector<Rgb>& pixels)
{
    Image image{width, height, {}, {}};
    for (const Rgb& c : pixels) { image.pixels.push_back(to_float(c)); }
    return image;
}

/// Numbers of very different size, some of them 0.
EnvironmentMap motley(int width, int height)
{
    std::vector<Rgb> pixels;
    for (int i = 0; i < width * height; ++i) {
        const auto u = [&](std::uint64_t k) {
            return uniform(7, 0, static_cast<std::uint64_t>(i), k);
        };
        pixels.push_back(u(0) < 0.25 ? Rgb{} : Rgb{u(1), u(2), u(3)} * std::pow(30.0, u(4)));
    }
    return EnvironmentMap(image_of(width, height, pixels));
}

Vec3 direction(double y, double phi)
{
    const double sine = std::sqrt((1.0 - y) * (1.0 + y));
    return {sine * std::cos(phi), y, sine * std::sin(phi)};
}

/// Edges of a row's cosine and of a column's azimuth, by the convention of the contract.
double row_edge(const Image& image, int row)
{
    return std::cos(pi * row / image.height);
}
double column_edge(const Image& image, int column)
{
    return 2.0 * pi * (static_cast<double>(column) / image.width - 0.5);
}
Vec3 centre(const Image& image, int column, int row)
{
    return direction(0.5 * (row_edge(image, row) + row_edge(image, row + 1)),
                     0.5 * (column_edge(image, column) + column_edge(image, column + 1)));
}

/// Integral of (a + b cos(phi))+ from phi0 to phi1, b >= 0, both within [-2 pi, 2 pi].
double positive_part(double a, double b, double phi0, double phi1)
{
    if (a <= -b) { return 0.0; }
    const double arc = a >= b ? pi : std::acos(-a / b);  // positive for |phi| < arc
    double sum = 0.0;
    for (const double turn : {-2.0 * pi, 0.0, 2.0 * pi}) {
        const double from = std::max(phi0, turn - arc), to = std::min(phi1, turn + arc);
        if (from < to) { sum += a * (to - from) + b * (std::sin(to) - std::sin(from)); }
    }
    return sum;
}

/// Integral of (n . w)+ over a texel: closed in phi, midpoints in theta.
double projected_solid_angle(const Image& image, int column, int row, Dir3 n, int steps)
{
    const double azimuth = std::atan2(n.z(), n.x());
    const double across = std::hypot(n.x(), n.z());
    const double step = pi / image.height / steps;
    double sum = 0.0;
    for (int i = 0; i < steps; ++i) {
        const double theta = pi * row / image.height + (i + 0.5) * step;
        sum += std::sin(theta) * positive_part(n.y() * std::cos(theta), across * std::sin(theta),
                                               column_edge(image, column) - azimuth,
                                               column_edge(image, column + 1) - azimuth);
    }
    return sum * step;
}

Rgb irradiance_by_texels(const EnvironmentMap& map, Dir3 n, int steps)
{
    const Image& image = map.image();
    Rgb E;
    for (int row = 0; row < image.height; ++row) {
        for (int column = 0; column < image.width; ++column) {
            E += map.radiance(centre(image, column, row)) *
                 projected_solid_angle(image, column, row, n, steps);
        }
    }
    return E;
}

/// Draws with the whole of pdf, map and light.
auto samples_of(const EnvironmentLight& light)
{
    return [light](test::Draw d) { return sample(light, d.s); };
}

Dir3 dir_of(const json& j)
{
    return normalize(test::vec_of(j));
}

void expect_near(Rgb x, Rgb e, test::Tolerance tolerance)
{
    for (const auto& [a, b] : {std::pair{x.r, e.r}, {x.g, e.g}, {x.b, e.b}}) {
        EXPECT_TRUE(tolerance.holds(a, b)) << a << " for " << b;
    }
}

/// A map that holds the average over each texel of L(w).
template <class L>
EnvironmentMap map_of_averages(int width, int height, L radiance)
{
    Image image{width, height, {}, {}};
    constexpr int parts = 4;
    for (int row = 0; row < height; ++row) {
        for (int column = 0; column < width; ++column) {
            double sum = 0.0;
            for (int k = 0; k < parts * parts; ++k) {
                const int i = k % parts, j = k / parts;
                const double t = (i + 0.5) / parts, f = (j + 0.5) / parts;
                const double y = row_edge(image, row) * (1.0 - f) + row_edge(image, row + 1) * f;
                sum += radiance(direction(y, column_edge(image, column) * (1.0 - t) +
                                                 column_edge(image, column + 1) * t));
            }
            image.pixels.push_back(to_float(Rgb::grey(sum / (parts * parts))));
        }
    }
    return EnvironmentMap(image);
}

/// Cases of lights_environment by type, each with a seed of its own.
class EnvironmentOracle : public testing::Test {
  protected:
    template <class Check>
    void each(const std::string& type, Check check)
    {
        std::uint64_t seed = 100;
        int checked = 0;
        for (const json& c : file["cases"]) {
            ++seed;
            if (c["env"]["type"] != type) { continue; }
            SCOPED_TRACE(c["id"].get<std::string>());
            check(c, seed);
            ++checked;
        }
        EXPECT_GT(checked, 0);
    }
    /// Within 4 standard errors, and counted.
    void check(test::Estimate estimate, double expected, double slack = 0.0)
    {
        const double off = estimate.off(expected);
        EXPECT_LE(std::abs(estimate.mean - expected), 4.0 * estimate.standard_error + slack)
            << off << " standard errors";
        offsets.add(off);
    }
    json file = oracle("lights_environment");
    test::Tolerance tolerance{file["tolerance"]};
    test::Offsets offsets;
};

TEST_F(EnvironmentOracle, EveryCaseIsOfAKindThatIsTestedHere)
{
    std::size_t known = 0;
    for (const json& c : file["cases"]) {
        const std::string type = c["env"]["type"];
        known += type == "constant" || type == "linear" || type == "quadratic" || type == "cap" ||
                 type == "equirect";
    }
    EXPECT_EQ(known, file["case_count"].get<std::size_t>());
}

TEST_F(EnvironmentOracle, AConstantSkyGivesPiL)
{
    each("constant", [&](const json& c, std::uint64_t seed) {
        const Rgb L = test::rgb_of(c["env"]["L"]), E = test::rgb_of(c["E"]);
        const Dir3 n = dir_of(c["n"]);
        expect_near(L * closed_irradiance(EnvironmentLight{}, {}, n).value_or(0.0), E, tolerance);
        check(test::irradiance_by_samples(samples_of({}), n, 20000, seed), E.g / L.g);
        const auto map =
            std::make_shared<const EnvironmentMap>(image_of(6, 3, std::vector<Rgb>(18, L)));
        expect_near(irradiance_by_texels(*map, n, 2000), E, {1e-6, 0.0});
        check(test::irradiance_by_samples(samples_of({map, 0.4}), n, 20000, seed + 1000),
              luminance(E));
    });
    EXPECT_GT(offsets.rms(), 0.5);  // of 12 alone
    EXPECT_LT(offsets.rms(), 1.5);
}

TEST_F(EnvironmentOracle, LinearAndQuadraticSkiesHaveTheirMoments)
{
    constexpr int width = 256, height = 128;
    // L and the cosine both change by at most b and 1 a radian; against its average over a texel
    // of radius r each is off by at most that times r, and only the product of the two is lost:
    // |error| <= b r^2 over the hemisphere's 2 pi.
    const double r = std::hypot(pi / width, 0.5 * pi / height);
    for (const bool square : {false, true}) {
        each(square ? "quadratic" : "linear", [&](const json& c, std::uint64_t seed) {
            const double a = c["env"]["a"], b = c["env"]["b"], E = c["E"];
            const Dir3 axis = dir_of(c["env"]["axis"]), n = dir_of(c["n"]);
            const auto map =
                std::make_shared<const EnvironmentMap>(map_of_averages(width, height, [&](Vec3 w) {
                    const double x = dot(w, axis);
                    return a + b * (square ? x * x : x);
                }));
            const double slack = 2.0 * pi * b * r * r + 1e-6 * E;
            EXPECT_NEAR(irradiance_by_texels(*map, n, 4).g, E, slack);
            check(test::irradiance_by_samples(samples_of({map, 0.0}), n, 20000, seed), E, slack);
        });
    }
    EXPECT_GT(offsets.rms(), 0.6);  // of 16 alone
    EXPECT_LT(offsets.rms(), 1.4);
}

TEST_F(EnvironmentOracle, ACapIsTheSun)
{
    each("cap", [&](const json& c, std::uint64_t seed) {
        const double half_angle = c["env"]["half_angle"], L = c["env"]["L"], E = c["E"];
        const Dir3 axis = dir_of(c["env"]["axis"]), n = dir_of(c["n"]);
        const double s = std::sin(half_angle);
        EXPECT_PRED2([&](double x, double e) { return tolerance.holds(x, e); },
                     L * cap_irradiance(s, dot(n, axis)), E);
        const DirectionalLight sun{-axis, half_angle};
        const double E_perp = pi * L * s * s;
        const auto draw = [&](test::Draw d) { return sample(sun, d.s); };
        const test::Estimate unit = test::irradiance_by_samples(draw, n, 40000, seed);
        check({E_perp * unit.mean, E_perp * unit.standard_error}, E);
    });
    EXPECT_GT(offsets.rms(), 0.5);  // of 10 alone
    EXPECT_LT(offsets.rms(), 1.5);
}

std::shared_ptr<const EnvironmentMap> equirect(const json& env)
{
    std::vector<Rgb> pixels;
    for (const json& row : env["rows"]) {
        for (const json& pixel : row) { pixels.push_back(test::rgb_of(pixel)); }
    }
    return std::make_shared<const EnvironmentMap>(image_of(env["width"], env["height"], pixels));
}

TEST_F(EnvironmentOracle, MapsGiveTheirIrradianceByTexelsAndBySamples)
{
    each("equirect", [&](const json& c, std::uint64_t seed) {
        const auto map = equirect(c["env"]);
        for (std::size_t k = 0; k < c["n"].size(); ++k) {
            const Dir3 n = dir_of(c["n"][k]);
            const Rgb E = test::rgb_of(c["E"][k]);
            expect_near(irradiance_by_texels(*map, n, 1000), E, tolerance);
            check(test::irradiance_by_samples(samples_of({map, 0.0}), n, 40000, 1000 * seed + k),
                  luminance(E));
        }
    });
    EXPECT_GT(offsets.rms(), 0.7) << offsets.count();
    EXPECT_LT(offsets.rms(), 1.35) << offsets.count();
}

TEST_F(EnvironmentOracle, MapsHaveTheirSolidAnglesRadianceAndDensity)
{
    const test::Tolerance tight(1e-6, 0.0);
    each("equirect", [&](const json& c, std::uint64_t /*seed*/) {
        const auto map = equirect(c["env"]);
        const json& rows = c["texel_solid_angle_per_row"];
        for (int row = 0; row < map->image().height; ++row) {
            EXPECT_NEAR(map->texel_solid_angle(row), rows[static_cast<std::size_t>(row)], 1e-12);
        }
        EXPECT_NEAR(map->luminance_integral() / c["luminance_times_solid_angle_sum"].get<double>(),
                    1.0, 1e-6);
        Rgb mean;
        for (int row = 0; row < map->image().height; ++row) {
            for (int column = 0; column < map->image().width; ++column) {
                mean += map->radiance(centre(map->image(), column, row)) *
                        (map->texel_solid_angle(row) / (4.0 * pi));
            }
        }
        expect_near(mean, test::rgb_of(c["mean_radiance"]), tight);
        for (const json& query : c["pdf_queries"]) {
            const LightSample seen = look(EnvironmentLight{map, 0.0}, dir_of(query["w"]));
            EXPECT_TRUE(tight.holds(seen.pdf, query["pdf"])) << seen.pdf << " for " << query["pdf"];
            expect_near(seen.L, test::rgb_of(query["L"]), tight);
        }
    });
}

TEST(Environment, TexelsCoverTheSphere)
{
    for (const auto& [width, height] :
         {std::pair{1, 1}, {2, 1}, {1, 2}, {7, 5}, {64, 32}, {1, 4096}}) {
        const EnvironmentMap map = motley(width, height);
        double sum = 0.0;
        for (int row = 0; row < height; ++row) { sum += map.texel_solid_angle(row) * width; }
        EXPECT_NEAR(sum, 4.0 * pi, 1e-12) << width << " x " << height;
    }
}

TEST(Environment, ItsDensityIntegratesToOne)
{
    const EnvironmentMap map = motley(24, 10);
    double sum = 0.0;
    for (int row = 0; row < 10; ++row) {
        const double top = row_edge(map.image(), row), bottom = row_edge(map.image(), row + 1);
        for (int i = 0; i < 4; ++i) {  // constant inside; the places are not the texels' own
            for (int j = 0; j < 24 * 5; ++j) {
                sum += map.pdf(direction(bottom + (top - bottom) * (i + 0.5) / 4.0,
                                         2.0 * pi * (j + 0.5) / (24 * 5) - pi)) *
                       (top - bottom) / 4.0 * 2.0 * pi / (24 * 5);
            }
        }
    }
    EXPECT_NEAR(sum, 1.0, 1e-6);
}

TEST(Environment, TexelsAreDrawnByLuminanceTimesSolidAngleAndUniformlyInside)
{
    constexpr int width = 16, height = 8, samples = 200000;
    const auto map = std::make_shared<const EnvironmentMap>(motley(width, height));
    const double rotation = 0.7;
    std::vector<double> counts(4 * map->image().pixels.size());  // quarters of texels
    const auto bin = [](int row, int column, int quarter) {
        const int index = (row * width + column) * 4 + quarter;
        return static_cast<std::size_t>(index);
    };
    for (int i = 0; i < samples; ++i) {
        const Dir3 w = sample(EnvironmentLight{map, rotation}, test::draw(3, i).s).wi;
        // Azimuth runs from +X by +Z; turning about +Y runs against it.
        const double turns = (std::atan2(w.z(), w.x()) + rotation) / (2.0 * pi) + 0.5;
        const double u = width * (turns - std::floor(turns)), v = height * std::acos(w.y()) / pi;
        const int column = static_cast<int>(u), row = static_cast<int>(v);
        const double middle = 0.5 * (row_edge(map->image(), row) + row_edge(map->image(), row + 1));
        const int quarter = (u - column < 0.5 ? 0 : 1) + (w.y() < middle ? 2 : 0);
        counts[bin(row, column, quarter)] += 1.0;
    }
    double statistic = 0.0, degrees = -1.0;
    for (int row = 0; row < height; ++row) {
        for (int column = 0; column < width; ++column) {
            const Rgb L = to_double(map->image().pixels[map->image().at(column, row)]);
            const double share =
                luminance(L) * map->texel_solid_angle(row) / map->luminance_integral();
            for (int quarter = 0; quarter < 4; ++quarter) {
                const double expected = 0.25 * samples * share;
                const double observed = counts[bin(row, column, quarter)];
                if (expected == 0.0) {
                    EXPECT_EQ(observed, 0.0);
                    continue;
                }
                statistic += std::pow(observed - expected, 2) / expected;
                degrees += 1.0;
            }
        }
    }
    EXPECT_GT(test::gamma_q(0.5 * degrees, 0.5 * statistic), 1e-3)
        << statistic << " of " << degrees;
}

TEST(Environment, AConstantSkyIsDrawnUniformly)
{
    const EnvironmentLight sky;
    const test::Chi2 result =
        test::chi2_directions([&](int i) -> Vec3 { return sample(sky, test::draw(3, i).s).wi; },
                              [&](Vec3 w) { return look(sky, normalize(w)).pdf; }, 100000);
    EXPECT_GT(result.p, 1e-3) << result.statistic << " of " << result.degrees;
    EXPECT_NEAR(result.integral, 1.0, 1e-9);
}

TEST(Environment, ASampleIsWhatALookAlongItSees)
{
    const EnvironmentLight light{std::make_shared<const EnvironmentMap>(motley(9, 6)), 2.1};
    for (int i = 0; i < 10000; ++i) {
        const LightSample drawn = sample(light, test::draw(5, i).s);
        const LightSample seen = look(light, drawn.wi);
        EXPECT_EQ(drawn.L, seen.L);
        EXPECT_EQ(drawn.pdf, seen.pdf);
        EXPECT_NEAR(length(drawn.wi), 1.0, 1e-14);
    }
}

TEST(Environment, NeverDrawsABlackTexelNotEvenAtTheEndsOfTheUnitSquare)
{
    const double last = std::nextafter(1.0, 0.0);
    for (int lit = 0; lit < 12; ++lit) {  // one lit texel: first, last, and in between
        std::vector<Rgb> pixels(12);
        pixels[static_cast<std::size_t>(lit)] = {0.0, 0.0, 1e-3};
        const EnvironmentLight light{std::make_shared<const EnvironmentMap>(image_of(4, 3, pixels)),
                                     1.0 + lit};
        for (const double u : {0.0, 1e-300, 0.3, 0.5, last}) {
            for (const double v : {0.0, 1e-300, 0.5, 0.7, last}) {
                const LightSample drawn = sample(light, {u, v});
                EXPECT_GT(drawn.pdf, 0.0) << lit << ' ' << u << ' ' << v;
                EXPECT_GT(drawn.L.b, 0.0) << lit << ' ' << u << ' ' << v;
            }
        }
    }
}

TEST(Environment, ASingleBrightTexelConverges)
{
    constexpr int width = 512, height = 256, column = 137, row = 40;
    std::vector<Rgb> pixels(static_cast<std::size_t>(width) * height, Rgb::grey(1e-6));
    pixels[static_cast<std::size_t>(row) * width + column] = Rgb::grey(1e7);
    const auto map = std::make_shared<const EnvironmentMap>(image_of(width, height, pixels));
    const Dir3 n = normalize(centre(map->image(), column, row));
    const test::Estimate E = test::irradiance_by_samples(samples_of({map, 0.0}), n, 1000, 1);
    EXPECT_LT(E.standard_error, 1e-5 * E.mean);
    EXPECT_NEAR(E.mean / (1e7 * projected_solid_angle(map->image(), column, row, n, 100)), 1.0,
                1e-5);
}

TEST(Environment, AConstantMapHasNoVarianceWhereTheCosineIsDrawnToo)
{
    const EnvironmentLight light{
        std::make_shared<const EnvironmentMap>(image_of(5, 7, std::vector<Rgb>(35, {0.5, 2, 3}))),
        0.3};
    for (const Vec3 normal : {Vec3{0, 1, 0}, Vec3{1, 0, 0}, Vec3{-0.3, -0.8, 0.6}}) {
        const Frame frame = frame_around(normalize(normal));
        for (int i = 0; i < 1000; ++i) {
            const Vec3 w = warp::cosine_hemisphere(test::draw(2, i).s);
            const LightSample seen = look(light, normalize(frame.to_world(w)));
            const double weight = w.z / warp::cosine_hemisphere_pdf(w.z);
            EXPECT_NEAR(seen.L.g * weight, 2.0 * pi, 1e-14);
            EXPECT_EQ(seen.L, (Rgb{0.5, 2, 3}));
        }
    }
}

TEST(Environment, RowZeroIsTheZenithAndColumnsRunFromWestBySouth)
{
    // u = 1/2 + atan2(z, x) / 2 pi: -X at the edges, -Z at 1/4, +X in the middle, +Z at 3/4.
    std::vector<Rgb> pixels;
    for (const double L : {1, 2, 3, 4, 5, 6, 7, 8}) { pixels.push_back(Rgb::grey(L)); }
    const EnvironmentMap map(image_of(4, 2, pixels));
    const double h = 0.1;
    const auto at = [&](double x, double y, double z) {
        return map.radiance(normalize({x, y, z})).g;
    };
    EXPECT_EQ(at(-1, h, -h), 1.0);  // above: a little past -X toward -Z
    EXPECT_EQ(at(h, h, -1), 2.0);
    EXPECT_EQ(at(1, h, h), 3.0);
    EXPECT_EQ(at(-h, h, 1), 4.0);
    EXPECT_EQ(at(-1, -h, -h), 5.0);
    EXPECT_EQ(at(-h, -h, 1), 8.0);
}

TEST(Environment, PolesSeamsAndRoundingStayInTheMap)
{
    const EnvironmentMap map = motley(16, 9);
    const double beyond = 1.0 + 1e-12;
    for (const double x : {-1.0, -0.0, 0.0, 1.0}) {
        for (const double z : {-1.0, -0.0, 0.0, 1.0}) {
            for (const double y : {-beyond, -1.0, -0.0, 0.0, 1.0, beyond}) {
                const Rgb L = map.radiance({x, y, z});
                EXPECT_TRUE(L.r >= 0.0 && L.g >= 0.0 && L.b >= 0.0);
                EXPECT_GE(map.pdf({x, y, z}), 0.0);
            }
        }
    }
    EXPECT_EQ(map.radiance({0, beyond, 0}), map.radiance({0, 1, 0}));
    EXPECT_EQ(map.radiance({0, -beyond, 0}), map.radiance({0, -1, 0}));
    EXPECT_EQ(map.radiance({-1, 0, 0.0}), map.radiance({-1, 0, -0.0}));  // the seam is one place
}

TEST(Environment, RotationTurnsItCounterClockwiseSeenFromAbove)
{
    std::vector<Rgb> pixels(32);
    pixels[12] = Rgb::grey(1.0);  // just above +X, a little toward +Z
    const auto map = std::make_shared<const EnvironmentMap>(image_of(8, 4, pixels));
    const Dir3 east = normalize(centre(map->image(), 4, 1));
    const Dir3 north = normalize({east.z(), east.y(), -east.x()});  // a quarter turn: x to -z
    EXPECT_EQ(look(EnvironmentLight{map, 0.0}, east).L.g, 1.0);
    EXPECT_EQ(look(EnvironmentLight{map, 0.5 * pi}, north).L.g, 1.0);
    EXPECT_EQ(look(EnvironmentLight{map, 0.5 * pi}, east).L.g, 0.0);
    EXPECT_EQ(look(EnvironmentLight{map, 0.5 * pi}, -north).L.g, 0.0);
    // What is drawn turns with it.
    const LightSample drawn = sample(EnvironmentLight{map, 0.5 * pi}, {0.5, 0.5});
    EXPECT_GT(dot(drawn.wi, north), 0.99);
}

TEST(Environment, ABlackMapShinesNowhere)
{
    const EnvironmentLight light{
        std::make_shared<const EnvironmentMap>(image_of(3, 2, std::vector<Rgb>(6))), 0.0};
    EXPECT_FALSE(sample(light, {0.3, 0.6}).wi);
    EXPECT_EQ(look(light, normalize({1, 2, 3})).pdf, 0.0);
    EXPECT_EQ(look(light, normalize({1, 2, 3})).L, Rgb{});
}

TEST(Environment, TheLargestAndLeastFloatsKeepItsNumbersFinite)
{
    const auto most = static_cast<double>(std::numeric_limits<float>::max());
    const auto least = static_cast<double>(std::numeric_limits<float>::denorm_min());
    for (const double L : {least, most}) {
        const EnvironmentLight light{std::make_shared<const EnvironmentMap>(image_of(
                                         3, 2, {Rgb{}, Rgb::grey(L), {}, {}, {}, Rgb::grey(L)})),
                                     0.0};
        for (int i = 0; i < 100; ++i) {
            const LightSample drawn = sample(light, test::draw(8, i).s);
            EXPECT_TRUE(std::isfinite(drawn.pdf) && drawn.pdf > 0.0);
            EXPECT_NEAR(drawn.L.g / L, 1.0, 1e-12);
        }
    }
}

}  // namespace
}  // namespace relight
