#include "core/light/environment.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/base/warp.h"
#include "tests/chi2.h"
#include "tests/light/environment_maps.h"

namespace relight {
namespace {

using std::numbers::pi;

TEST(Environment, TexelsCoverTheSphere)
{
    for (const auto& [width, height] :
         {std::pair{1, 1}, {2, 1}, {1, 2}, {7, 5}, {64, 32}, {1, 4096}}) {
        const EnvironmentMap map = test::motley(width, height);
        double sum = 0.0;
        for (int row = 0; row < height; ++row) { sum += map.texel_solid_angle(row) * width; }
        EXPECT_NEAR(sum, 4.0 * pi, 1e-12) << width << " x " << height;
    }
}

TEST(Environment, ItsDensityIntegratesToOne)
{
    const EnvironmentMap map = test::motley(24, 10);
    double sum = 0.0;
    for (int row = 0; row < 10; ++row) {
        const double top = test::row_edge(map.image(), row),
                     bottom = test::row_edge(map.image(), row + 1);
        for (int i = 0; i < 4; ++i) {  // constant inside; the places are not the texels' own
            for (int j = 0; j < 24 * 5; ++j) {
                sum += map.pdf(test::direction(bottom + (top - bottom) * (i + 0.5) / 4.0,
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
    const auto map = std::make_shared<const EnvironmentMap>(test::motley(width, height));
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
        const double middle =
            0.5 * (test::row_edge(map->image(), row) + test::row_edge(map->image(), row + 1));
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
    const EnvironmentLight light{std::make_shared<const EnvironmentMap>(test::motley(9, 6)), 2.1};
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
        const EnvironmentLight light{
            std::make_shared<const EnvironmentMap>(test::image_of(4, 3, pixels)), 1.0 + lit};
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
    const auto map = std::make_shared<const EnvironmentMap>(test::image_of(width, height, pixels));
    const Dir3 n = normalize(test::centre(map->image(), column, row));
    const test::Estimate E = test::irradiance_by_samples(test::samples_of({map, 0.0}), n, 1000, 1);
    EXPECT_LT(E.standard_error, 1e-5 * E.mean);
    EXPECT_NEAR(E.mean / (1e7 * test::projected_solid_angle(map->image(), column, row, n, 100)),
                1.0, 1e-5);
}

TEST(Environment, AConstantMapHasNoVarianceWhereTheCosineIsDrawnToo)
{
    const EnvironmentLight light{std::make_shared<const EnvironmentMap>(
                                     test::image_of(5, 7, std::vector<Rgb>(35, {0.5, 2, 3}))),
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
    const EnvironmentMap map(test::image_of(4, 2, pixels));
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
    const EnvironmentMap map = test::motley(16, 9);
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

/// Mostly dark, in parts black, with lamps of any brightness: no two texels alike.
Image lamps(int width, int height)
{
    Image image{width, height, {}, {}};
    for (std::uint64_t i = 0; i < image.at(0, height); ++i) {
        const auto u = [&](std::uint64_t k) { return uniform(11, 0, i, k); };
        const bool is_black = i / 64 % 3 == 1 || u(0) < 0.1;
        const double L = (1.0 + u(1)) * (u(2) < 0.002 ? 1e6 * u(3) : 1e-3);
        image.pixels.push_back(
            to_float(is_black ? Rgb{} : Rgb{L, 1e-6 * static_cast<double>(i), L}));
    }
    return image;
}

/// The first whose running sum is beyond the share u of all.
std::size_t reached(const std::vector<double>& sums, double u)
{
    return static_cast<std::size_t>(std::upper_bound(sums.begin(), sums.end(), u * sums.back()) -
                                    sums.begin());
}

TEST(Environment, ASampleIsOfTheRowAndTheTexelThatItsNumbersReach)
{
    // Rows of one texel, of less than a block, of no whole blocks, and of more blocks than the
    // guide can name.
    for (const auto& [width, height] :
         {std::pair{1, 9}, {3, 5}, {6, 3}, {257, 130}, {1024, 64}, {300'001, 2}}) {
        const Image image = lamps(width, height);
        const EnvironmentMap map(image);
        std::vector<double> down;
        std::vector<std::vector<double>> along;
        for (int y = 0; y < height; ++y) {
            std::vector<double>& row = along.emplace_back();
            double sum = 0.0;
            for (int x = 0; x < width; ++x) {
                row.push_back(sum += luminance(to_double(image.pixels[image.at(x, y)])));
            }
            down.push_back((y == 0 ? 0.0 : down.back()) + sum * map.texel_solid_angle(y));
        }
        for (int i = 0; i < 2000; ++i) {
            const Sample2 s = test::draw(13, i).s;
            const std::size_t y = reached(down, s.v), x = reached(along[y], s.u);
            const EnvironmentMap::Seen seen = map.sample(s);
            ASSERT_EQ(to_float(seen.L), image.pixels[y * along[y].size() + x]) << x << ' ' << y;
            ASSERT_EQ(seen.L, map.radiance(seen.w));
            ASSERT_NEAR(seen.pdf, luminance(seen.L) / down.back(), 1e-12 * seen.pdf);
        }
    }
}

TEST(Environment, EveryHeightIsInTheRowBetweenItsEdges)
{
    for (const int height : {1, 2, 3, 4, 7, 100, 512, 4096}) {
        std::vector<Rgb> pixels(static_cast<std::size_t>(height));
        for (std::size_t row = 0; row < pixels.size(); ++row) {
            pixels[row] = Rgb::grey(1.0 + static_cast<double>(row));
        }
        const EnvironmentMap map(test::image_of(1, height, pixels));
        const auto row_at = [&](double y) { return map.radiance({0.0, y, 0.0}).g - 1.0; };
        for (int row = 0; row < height; ++row) {
            const double top = map.tables().edges[row];
            EXPECT_NEAR(top, std::cos(pi * row / height), 1e-15);
            EXPECT_EQ(row_at(top), row) << "an edge is of the row below it, " << height;
            if (row == 0) { continue; }
            EXPECT_EQ(row_at(std::nextafter(top, 2.0)), row - 1) << height;
            EXPECT_EQ(row_at(std::nextafter(top, -2.0)), row) << height;
            EXPECT_EQ(row_at(0.5 * (top + map.tables().edges[row - 1])), row - 1);
        }
        EXPECT_EQ(row_at(-1.0), height - 1);
    }
}

TEST(Environment, ATexelTakesNineteenBytesAndItsImageIsKept)
{
    const Image image = lamps(1022, 512);
    const EnvironmentMap map(image);
    EXPECT_EQ(map.image().pixels, image.pixels);
    EXPECT_LE(map.bytes(), 19 * image.pixels.size());
}

TEST(Environment, RotationTurnsItCounterClockwiseSeenFromAbove)
{
    std::vector<Rgb> pixels(32);
    pixels[12] = Rgb::grey(1.0);  // just above +X, a little toward +Z
    const auto map = std::make_shared<const EnvironmentMap>(test::image_of(8, 4, pixels));
    const Dir3 east = normalize(test::centre(map->image(), 4, 1));
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
        std::make_shared<const EnvironmentMap>(test::image_of(3, 2, std::vector<Rgb>(6))), 0.0};
    EXPECT_FALSE(sample(light, {0.3, 0.6}).wi);
    EXPECT_EQ(look(light, normalize({1, 2, 3})).pdf, 0.0);
    EXPECT_EQ(look(light, normalize({1, 2, 3})).L, Rgb{});
}

TEST(Environment, TheLargestAndLeastFloatsKeepItsNumbersFinite)
{
    const auto most = static_cast<double>(std::numeric_limits<float>::max());
    const auto least = static_cast<double>(std::numeric_limits<float>::denorm_min());
    for (const double L : {least, most}) {
        const EnvironmentLight light{std::make_shared<const EnvironmentMap>(test::image_of(
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
