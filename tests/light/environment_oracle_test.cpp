#include <gtest/gtest.h>

#include "core/light/cap.h"
#include "core/light/light.h"
#include "tests/light/environment_maps.h"
#include "tests/oracle.h"

namespace relight {
namespace {

using nlohmann::json;
using std::numbers::pi;

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
                const double y =
                    test::row_edge(image, row) * (1.0 - f) + test::row_edge(image, row + 1) * f;
                sum += radiance(test::direction(y, test::column_edge(image, column) * (1.0 - t) +
                                                       test::column_edge(image, column + 1) * t));
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
    json file = test::oracle("lights_environment");
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
        check(test::irradiance_by_samples(test::samples_of({}), n, 20000, seed), E.g / L.g);
        const auto map =
            std::make_shared<const EnvironmentMap>(test::image_of(6, 3, std::vector<Rgb>(18, L)));
        expect_near(test::irradiance_by_texels(*map, n, 2000), E, {1e-6, 0.0});
        check(test::irradiance_by_samples(test::samples_of({map, 0.4}), n, 20000, seed + 1000),
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
            EXPECT_NEAR(test::irradiance_by_texels(*map, n, 4).g, E, slack);
            check(test::irradiance_by_samples(test::samples_of({map, 0.0}), n, 20000, seed), E,
                  slack);
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
    return std::make_shared<const EnvironmentMap>(
        test::image_of(env["width"], env["height"], pixels));
}

TEST_F(EnvironmentOracle, MapsGiveTheirIrradianceByTexelsAndBySamples)
{
    each("equirect", [&](const json& c, std::uint64_t seed) {
        const auto map = equirect(c["env"]);
        for (std::size_t k = 0; k < c["n"].size(); ++k) {
            const Dir3 n = dir_of(c["n"][k]);
            const Rgb E = test::rgb_of(c["E"][k]);
            expect_near(test::irradiance_by_texels(*map, n, 1000), E, tolerance);
            check(test::irradiance_by_samples(test::samples_of({map, 0.0}), n, 40000,
                                              1000 * seed + k),
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
                mean += map->radiance(test::centre(map->image(), column, row)) *
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

}  // namespace
}  // namespace relight
