// Sobol's points and the warps.
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "core/base/random.h"
#include "core/base/sobol.h"
#include "core/base/warp.h"

namespace relight {
namespace {

TEST(Sobol, EveryPowerOfTwoPrefixHasOnePointInEachElementaryInterval)
{
    for (std::uint64_t key = 0; key < 40; ++key) {
        const Sequence sequence(7, key, 0, 3);
        for (unsigned log_n = 0; log_n <= 8; ++log_n) {
            const unsigned n = 1U << log_n;
            for (unsigned columns_log = 0; columns_log <= log_n; ++columns_log) {
                const unsigned columns = 1U << columns_log;
                const unsigned rows = n / columns;
                std::set<unsigned> cells;
                for (unsigned i = 0; i < n; ++i) {
                    const Sample2 s = sequence.at(i, static_cast<std::uint32_t>(key % 5));
                    cells.insert(static_cast<unsigned>(s.u * columns) * rows +
                                 static_cast<unsigned>(s.v * rows));
                }
                EXPECT_EQ(cells.size(), n) << columns << " x " << rows;
            }
        }
    }
}

TEST(Sobol, TheSecondCoordinateIsPascalsTriangleModTwo)
{
    for (unsigned k = 0; k < 32; ++k) {  // its columns; it is linear
        std::uint32_t column = 0x80000000U;
        for (unsigned step = 0; step < k; ++step) { column ^= column >> 1U; }
        EXPECT_EQ(sobol::reverse_bits(sobol::second_reversed(1U << k)), column) << k;
    }
    for (const std::uint32_t a : {1U, 77U, 0xdeadbeefU}) {
        for (const std::uint32_t b : {3U, 0x80000001U, 0x12345678U}) {
            EXPECT_EQ(sobol::second_reversed(a ^ b),
                      sobol::second_reversed(a) ^ sobol::second_reversed(b));
        }
    }
}

TEST(Sobol, PointsLieInTheOpenSquareAndEachIsUniformOverTheKeys)
{
    constexpr int keys = 20000;
    for (const std::uint32_t point : {0U, 1U, 77U}) {
        double u = 0.0;
        double v = 0.0;
        double uv = 0.0;
        for (int key = 0; key < keys; ++key) {
            const Sample2 s = Sequence(1, static_cast<std::uint64_t>(key), 2, 3).at(point, 4);
            ASSERT_TRUE(s.u > 0.0 && s.u < 1.0 && s.v > 0.0 && s.v < 1.0);
            u += s.u - 0.5;
            v += s.v - 0.5;
            uv += (s.u - 0.5) * (s.v - 0.5);
        }
        const double sigma = std::sqrt(keys / 12.0);
        EXPECT_LT(std::abs(u), 4.0 * sigma);
        EXPECT_LT(std::abs(v), 4.0 * sigma);
        EXPECT_LT(std::abs(uv), 4.0 * sigma / std::sqrt(12.0));
    }
}

TEST(Sobol, DifferentKeysAndPairsAreUncorrelated)
{
    // Means of 16 points of a smooth function: replicates must err independently.
    const auto mean = [](const Sequence& sequence, std::uint32_t pair) {
        double sum = 0.0;
        for (std::uint32_t i = 0; i < 16; ++i) {
            const Sample2 s = sequence.at(i, pair);
            sum += std::exp(s.u + 0.5 * s.v);
        }
        return sum / 16.0 - (std::exp(1.0) - 1.0) * 2.0 * (std::exp(0.5) - 1.0);
    };
    double squares = 0.0;
    double products[3] = {};
    constexpr int trials = 4000;
    for (int t = 0; t < trials; ++t) {
        const auto item = static_cast<std::uint64_t>(t);
        const double own = mean(Sequence(5, item, 0, 0), 0);
        squares += own * own;
        products[0] += own * mean(Sequence(5, item, 0, 1), 0);  // another replicate
        products[1] += own * mean(Sequence(5, item, 1, 0), 0);  // another light
        products[2] += own * mean(Sequence(5, item, 0, 0), 1);  // another pair
    }
    for (const double p : products) {
        EXPECT_LT(std::abs(p) / squares, 4.0 / std::sqrt(1.0 * trials));
    }
}

TEST(Sobol, ASmoothIntegrandErrsFourTimesLessThanPlainMonteCarloAt256)
{
    // Independent replicates of 16 points, as a vertex uses them.
    const auto integrand = [](double u, double v) {
        return std::cos(u) * (1.0 + v * v) + 0.3 * u * v;
    };
    const double exact = std::sin(1.0) * 4.0 / 3.0 + 0.3 / 4.0;
    double low_discrepancy = 0.0;
    double plain = 0.0;
    for (std::uint64_t trial = 0; trial < 400; ++trial) {
        double a = 0.0;
        double b = 0.0;
        for (std::uint32_t r = 0; r < 16; ++r) {
            const Sequence sequence(11, trial, 0, r);
            for (std::uint32_t i = 0; i < 16; ++i) {
                const Sample2 s = sequence.at(i, 0);
                a += integrand(s.u, s.v) / 256.0;
                const std::uint64_t n = r * 16U + i;
                b += integrand(uniform(12, trial, n, 0), uniform(12, trial, n, 1)) / 256.0;
            }
        }
        low_discrepancy += (a - exact) * (a - exact);
        plain += (b - exact) * (b - exact);
    }
    EXPECT_LT(4.0 * std::sqrt(low_discrepancy), std::sqrt(plain));
}

TEST(Warp, SineAndCosineAreThoseOfTheLibrary)
{
    for (int i = -4000; i <= 4000; ++i) {
        const double x = 0.25 * std::numbers::pi * i / 4000.0;
        const warp::SineCosine small = warp::sine_cosine(x);
        ASSERT_NEAR(small.sine, std::sin(x), 3e-16 * std::abs(std::sin(x)));
        ASSERT_NEAR(small.cosine, std::cos(x), 2e-16);
        const double turns = 2.0 * i / 4000.0;
        const warp::SineCosine any = warp::sine_cosine_of_turns(turns);
        ASSERT_NEAR(any.sine, std::sin(2.0 * std::numbers::pi * turns), 4e-15);
        ASSERT_NEAR(any.cosine, std::cos(2.0 * std::numbers::pi * turns), 4e-15);
    }
}

TEST(Warp, TheDiskAndTheTriangleKeepAreasInProportion)
{
    constexpr int side = 400;
    int inner = 0;
    int near_a = 0;
    for (int i = 0; i < side; ++i) {
        for (int j = 0; j < side; ++j) {
            const Sample2 s{(i + 0.5) / side, (j + 0.5) / side};
            const Vec3 d = warp::disk(s);
            ASSERT_LE(d.x * d.x + d.y * d.y, 1.0 + 1e-12);
            inner += d.x * d.x + d.y * d.y < 0.25 ? 1 : 0;
            const Sample2 b = warp::triangle(s);
            ASSERT_TRUE(b.u >= 0.0 && b.v >= 0.0 && b.u + b.v <= 1.0 + 1e-12);
            near_a += b.u + b.v < 0.5 ? 1 : 0;
        }
    }
    EXPECT_NEAR(inner / double(side * side), 0.25, 0.002);
    EXPECT_NEAR(near_a / double(side * side), 0.25, 0.002);
}

TEST(Warp, CosineHemisphereAndCapHaveTheirDensities)
{
    constexpr int side = 300;
    double cosine = 0.0;
    double squared = 0.0;
    double cap = 0.0;
    const double height = 0.01;
    for (int i = 0; i < side; ++i) {
        for (int j = 0; j < side; ++j) {
            const Sample2 s{(i + 0.5) / side, (j + 0.5) / side};
            const Vec3 w = warp::cosine_hemisphere(s);
            ASSERT_NEAR(dot(w, w), 1.0, 1e-12);
            cosine += w.z / (side * side);         // int cos (cos / pi) = 2/3
            squared += w.x * w.x / (side * side);  // and of x^2: 1/4
            const Vec3 c = warp::cap(s, height);
            ASSERT_NEAR(dot(c, c), 1.0, 1e-12);
            ASSERT_GE(c.z, 1.0 - height - 1e-15);
            cap += c.z / (side * side);
        }
    }
    EXPECT_NEAR(cosine, 2.0 / 3.0, 2e-4);
    EXPECT_NEAR(squared, 0.25, 1e-3);
    EXPECT_NEAR(cap, 1.0 - 0.5 * height, 1e-4 * height);
    EXPECT_DOUBLE_EQ(warp::cap_pdf(height) * 2.0 * std::numbers::pi * height, 1.0);
}

}  // namespace
}  // namespace relight
