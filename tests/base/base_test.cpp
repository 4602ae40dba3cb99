#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include "core/base/camera.h"
#include "core/base/parallel.h"
#include "core/base/random.h"
#include "core/base/result.h"

namespace relight {
namespace {

TEST(Dir3, IsOfUnitLengthForVectorsOfAnySize)
{
    for (const double size : {5e-324, 1e-300, 1e-9, 1.0, 1e9, 1e300}) {
        const Dir3 d = normalize(Vec3{3, -4, 12} * size);
        if (size < 1e-320) { continue; }  // too coarse to hold the proportions
        EXPECT_NEAR(d.x(), 3.0 / 13.0, 1e-15) << size;
        EXPECT_NEAR(dot(d, d), 1.0, 1e-15) << size;
    }
}

TEST(Dir3, IsNoDirectionForZeroAndForWhatIsNotFinite)
{
    EXPECT_FALSE(normalize({}));
    EXPECT_FALSE(normalize({std::numeric_limits<double>::infinity(), 0, 0}));
    EXPECT_FALSE(normalize({std::numeric_limits<double>::quiet_NaN(), 1, 0}));
}

TEST(Frame, IsRightHandedAndOrthonormalAroundAnyNormal)
{
    for (const Vec3 v : {Vec3{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {1e-9, 0, -1}, {1, 2, -3}}) {
        const Frame f = frame_around(normalize(v));
        EXPECT_NEAR(dot(cross(f.x, f.y), f.n), 1.0, 1e-14);
        EXPECT_NEAR(dot(f.x, f.n), 0.0, 1e-14);
        EXPECT_NEAR(dot(f.x, f.y), 0.0, 1e-14);
    }
}

TEST(ParallelFor, VisitsEveryIndexOnceOnAnyNumberOfThreads)
{
    for (const unsigned threads : {0U, 1U, 2U, 8U}) {
        for (const std::size_t count : {0U, 1U, 99U, 100U, 1001U}) {
            std::vector<std::atomic<int>> visits(count);
            Progress progress;
            parallel_for(count, 100, threads, progress, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) { ++visits[i]; }
            });
            for (const auto& v : visits) { EXPECT_EQ(v, 1); }
        }
    }
}

TEST(ParallelFor, StopsBetweenBlocksWhenAsked)
{
    Progress progress;
    std::atomic<int> blocks{0};
    parallel_for(1000, 1, 2, progress, [&](std::size_t, std::size_t) {
        if (++blocks == 10) { progress.stop(); }
    });
    EXPECT_LT(blocks, 100);
}

TEST(ParallelFor, RethrowsWhatABodyThrows)
{
    Progress progress;
    const auto body = [](std::size_t begin, std::size_t) {
        if (begin == 50) { throw std::runtime_error("fifty"); }
    };
    EXPECT_THROW(parallel_for(100, 1, 4, progress, body), std::runtime_error);
}

TEST(Uniform, LiesInTheUnitIntervalWithItsMeanAndVarianceAndNoRepeats)
{
    double sum = 0.0;
    double squares = 0.0;
    std::set<double> distinct;
    const int n = 100000;
    for (int i = 0; i < n; ++i) {
        const auto index = static_cast<std::uint64_t>(i);
        const double x = uniform(7, index / 100, index % 100, 1);
        ASSERT_GE(x, 0.0);
        ASSERT_LT(x, 1.0);
        sum += x;
        squares += x * x;
        distinct.insert(x);
    }
    const double mean = sum / n;
    EXPECT_NEAR(mean, 0.5, 5.0 * std::sqrt(1.0 / 12.0 / n));
    EXPECT_NEAR(squares / n - mean * mean, 1.0 / 12.0, 1e-3);
    EXPECT_EQ(distinct.size(), static_cast<std::size_t>(n));
}

TEST(Result, CarriesTheFirstErrorThroughTheWalk)
{
    const auto half = [](int x) -> Result<int> {
        if (x % 2 != 0) { return Error{Fault::OutOfRange, "odd", "/x", {}, {}}; }
        return x / 2;
    };
    EXPECT_EQ(Result<int>(8).and_then(half).and_then(half).value(), 2);
    const Result<int> odd = Result<int>(6).and_then(half).and_then(half).and_then(half);
    EXPECT_EQ(odd.error().fault, Fault::OutOfRange);
    EXPECT_EQ(Error(odd.error()).at("/lights/1").pointer, "/lights/1/x");
    EXPECT_EQ(fault_code(Fault::IndexOutOfRange), "index_out_of_range");
}

TEST(Camera, LooksAtItsTargetThroughTheMiddleAndKeepsRightOnTheRight)
{
    const Camera camera{{1, 2, 5}, {1, 2, 0}, {0, 1, 0}, 0.7};
    EXPECT_EQ(axes(camera).right, normalize({1, 0, 0}));
    const PixelRays pixels(camera, 640, 480);
    EXPECT_NEAR(dot(pixels.through(320, 240), normalize({0, 0, -1})), 1.0, 1e-15);
    EXPECT_GT(pixels.through(600, 240).x(), 0.0);
    EXPECT_GT(pixels.through(320, 10).y(), 0.0);
}

TEST(Camera, PixelsLieWhereTheContractPutsThem)  // section 9
{
    const Camera camera{{3, -1, 0.5}, {-0.2, 0.7, 2}, {0.1, 0.9, 0.4}, 1.1};
    const CameraAxes a = axes(camera);
    const double t = std::tan(0.55);
    for (const auto& [W, H] : {std::pair{640, 480}, {90, 160}, {1, 1}}) {
        const PixelRays pixels(camera, W, H);
        const ImagePlane plane(camera.fov_y, W, H);
        for (const double x : {0.0, 0.5, 0.37 * W, 1.0 * W}) {
            for (const double y : {0.0, 0.5, 0.81 * H, 1.0 * H}) {
                const Dir3 d = pixels.through(x, y);
                const double ahead = -dot(d, a.back);
                const double u = (2.0 * x / W - 1.0) * t * W / H, v = (1.0 - 2.0 * y / H) * t;
                EXPECT_NEAR(dot(d, d), 1.0, 1e-15);
                EXPECT_NEAR(dot(d, a.right) / ahead, u, 1e-15);
                EXPECT_NEAR(dot(d, a.up) / ahead, v, 1e-15);
                EXPECT_NEAR(plane.x(x), u, 1e-15);
                EXPECT_NEAR(plane.y(y), v, 1e-15);
            }
        }
    }
}

TEST(Camera, AnUpAlongTheViewStillGivesAFrame)
{
    const CameraAxes a = axes({{0, 5, 0}, {0, 0, 0}, {0, 1, 0}, 0.7});
    EXPECT_NEAR(dot(cross(a.right, a.up), a.back), 1.0, 1e-14);
}

}  // namespace
}  // namespace relight
