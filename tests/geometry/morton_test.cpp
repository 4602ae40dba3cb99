#include "core/geometry/morton.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <random>

namespace relight {
namespace {

using Order = std::vector<std::uint32_t>;

Order ordered(const std::vector<Point3>& points, unsigned threads = 1)
{
    Bounds box{points.empty() ? Point3{} : points[0], points.empty() ? Point3{} : points[0]};
    for (const Point3 p : points) { box.add(p); }
    Progress progress;
    return morton_order(points, box, threads, progress);
}

bool is_permutation(Order order, std::size_t count)
{
    Order all(count);
    std::iota(all.begin(), all.end(), 0U);
    std::sort(order.begin(), order.end());
    return order == all;
}

/// side x side points, a step apart, in no order.
std::vector<Point3> shuffled_grid(int side, double step)
{
    std::vector<Point3> points;
    for (int i = 0; i < side; ++i) {
        for (int j = 0; j < side; ++j) { points.push_back({step * j, 3.0, step * i}); }
    }
    std::shuffle(points.begin(), points.end(), std::mt19937(7));
    return points;
}

/// Of consecutive points, without the largest (a stray's).
double mean_step(const std::vector<Point3>& points, const Order& order)
{
    double sum = 0.0, largest = 0.0;
    for (std::size_t i = 1; i < order.size(); ++i) {
        const double step = length(points[order[i]] - points[order[i - 1]]);
        sum += step;
        largest = std::max(largest, step);
    }
    return (sum - largest) / static_cast<double>(order.size() - 2);
}

TEST(MortonOrder, GoesThroughTheOctantsXFirstThenYThenZ)  // the curve's definition
{
    std::vector<Point3> corners;
    for (int i = 7; i >= 0; --i) {
        const int y = i / 2 % 2;
        const int z = i / 4;
        corners.push_back({i % 2 * 1.0, y * 1.0, z * 1.0});
    }
    EXPECT_EQ(ordered(corners), (Order{7, 6, 5, 4, 3, 2, 1, 0}));
}

TEST(MortonOrder, HoldsEveryPointOnceWhicheverWayTheyLie)
{
    std::mt19937 random(1);
    std::uniform_real_distribution<double> unit;
    std::vector<Point3> points(5000);
    for (Point3& p : points) { p = {unit(random), 1e-9 * unit(random), 1e15 * unit(random)}; }
    EXPECT_TRUE(is_permutation(ordered(points), points.size()));
    for (Point3& p : points) { p.z = p.x < 0.5 ? 0.0 : 1e-300; }
    EXPECT_TRUE(is_permutation(ordered(points), points.size()));
}

TEST(MortonOrder, OfAShuffledGridStepsToNeighbours)
{
    // The curve steps 1, 1, 1 within each square of four and farther between them: less than
    // 2 steps in the mean, where the file's order has 0.52 sides.
    const auto points = shuffled_grid(300, 0.5);
    EXPECT_LT(mean_step(points, ordered(points)), 2.0 * 0.5);
}

TEST(MortonOrder, AStrayFarAwayLeavesTheOthersInOrder)
{
    // Cells hold at most 256 or so, a square of 16 x 16: 0.52 times that in the mean if they lie
    // there in no order. Without cells in cells, all but the stray are in one: 156.
    for (const double away : {1e4, 1e6, 1e9, 1e14}) {
        auto points = shuffled_grid(300, 1.0);
        points[77] = {-away, away, 0.0};
        const Order order = ordered(points);
        EXPECT_TRUE(is_permutation(order, points.size()));
        EXPECT_LT(mean_step(points, order), 10.0) << away;
    }
}

TEST(MortonOrder, ManyCrowdsAreEachPutInOrder)
{
    std::vector<Point3> points;  // 40 grids, each in a cell of its own
    for (int i = 0; i < 40; ++i) {
        const int column = i % 8;
        const int row = i / 8;
        for (const Point3 p : shuffled_grid(30, 1.0)) {
            points.push_back(p + Vec3{1e6 * column, 1e6 * row, 0.0});
        }
    }
    const Order order = ordered(points);
    EXPECT_TRUE(is_permutation(order, points.size()));
    double within = 0.0;
    for (std::size_t i = 1; i < order.size(); ++i) {
        const double step = length(points[order[i]] - points[order[i - 1]]);
        within += step < 1e3 ? step : 0.0;
    }
    EXPECT_LT(within / static_cast<double>(order.size()), 2.0);
}

TEST(MortonOrder, IsTheSameForAnyNumberOfThreads)
{
    auto points = shuffled_grid(500, 1.0);  // several blocks
    points[0].x = 1e7;                      // and a crowd of several in one cell
    const Order one = ordered(points, 1);
    EXPECT_TRUE(is_permutation(one, points.size()));
    for (const unsigned threads : {2U, 8U, 0U}) { EXPECT_EQ(ordered(points, threads), one); }
}

TEST(MortonOrder, OfPointsInOnePlaceIsTheirs)
{
    EXPECT_EQ(ordered({}), Order{});
    EXPECT_EQ(ordered({{1, 2, 3}}), Order{0});
    const Order order = ordered(std::vector<Point3>(5000, {1e15, -1e15, 5e-324}));
    EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
    EXPECT_EQ(order.size(), 5000U);
}

TEST(MortonOrder, TakesCoordinatesThatAreNoNumbers)
{
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    constexpr double infinity = std::numeric_limits<double>::infinity();
    auto points = shuffled_grid(50, 1.0);
    for (std::size_t i = 0; i < points.size(); i += 2) { points[i] = {nan, nan, nan}; }
    EXPECT_TRUE(is_permutation(ordered(points), points.size()));
    points[1] = {infinity, 0, -infinity};
    EXPECT_TRUE(is_permutation(ordered(points), points.size()));
    std::fill(points.begin(), points.end(), Point3{nan, nan, nan});
    EXPECT_TRUE(is_permutation(ordered(points), points.size()));
}

}  // namespace
}  // namespace relight
