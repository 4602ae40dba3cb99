#include "core/geometry/cloud_normals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <numeric>

#include "core/geometry/spacing.h"
#include "core/geometry/surface.h"
#include "tests/clouds.h"
#include "tests/shapes.h"

namespace relight {
namespace {

using test::cloud_of;
using test::Draws;
using test::random_plane;
using test::random_sphere;

Surface prepared(const Mesh& cloud, const CloudNormals& how = {}, unsigned threads = 1)
{
    Progress progress;
    return prepare(cloud, threads, progress, how);
}
std::vector<Dir3> normals_of(std::vector<Point3> places, const CloudNormals& how = {})
{
    return prepared(cloud_of(std::move(places)), how).normals;
}
std::size_t without_direction(const std::vector<Dir3>& normals)
{
    return static_cast<std::size_t>(
        std::count_if(normals.begin(), normals.end(), [](Dir3 n) { return !n; }));
}
std::vector<Point3> moved(std::vector<Point3> places, Vec3 shift)
{
    for (Point3& p : places) { p = p + shift; }
    return places;
}
Frame tilted()
{
    return frame_around(normalize({0.3, -0.5, 0.8}));
}

TEST(CloudNormals, OfAPlaneAreThePlanesWhereverItLies)
{
    Draws draws(1);
    for (const double size : {1e-3, 1.0, 1e5}) {
        const Mesh cloud = test::moved(cloud_of(random_plane(2000, draws)), tilted(), size,
                                       Vec3{4e5, -2e5, 1e3} * size);
        const Surface surface = prepared(cloud);
        EXPECT_EQ(surface.intake.normals_estimated, 2000U);
        for (const Dir3 n : surface.normals) {
            // The sky's side: of the plane's axes, z is the largest.
            ASSERT_GT(dot(n, tilted().n), 1.0 - 1e-9) << size;
        }
    }
}

TEST(CloudNormals, OfASphereAllFaceOutward)
{
    Draws draws(2);
    const std::vector<Point3> places = random_sphere(5000, draws);
    const std::vector<Dir3> normals = normals_of(moved(places, {100, 7, -30}));
    double squares = 0.0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const double cos = dot(normals[i], places[i] - Point3{});
        ASSERT_GT(cos, 0.9) << i;
        squares += 1.0 - cos * cos;
    }
    // rms 0.8 degrees; 13 points on a cap of curvature 1 lean by their uneven spread alone.
    EXPECT_LT(std::sqrt(squares / 5000.0), 0.02);
}

TEST(CloudNormals, OfATorusAllFaceOutwardHoweverThin)
{
    for (const double tube : {0.4, 0.05}) {
        Draws draws(3);
        std::vector<Point3> places;
        std::vector<Dir3> truth;
        while (places.size() < 20000) {
            const double u = draws.in(0, 2.0 * std::numbers::pi);
            const double v = draws.in(0, 2.0 * std::numbers::pi);
            // By area: the outer side is longer.
            if (draws.in(0, 1 + tube) > 1.0 + tube * std::cos(v)) { continue; }
            const Vec3 out{std::cos(u) * std::cos(v), std::sin(u) * std::cos(v), std::sin(v)};
            places.push_back(Point3{std::cos(u), std::sin(u), 0.0} + out * tube);
            truth.push_back(normalize(out));
        }
        const std::vector<Dir3> normals = normals_of(places);
        for (std::size_t i = 0; i < places.size(); ++i) {
            ASSERT_GT(dot(normals[i], truth[i]), 0.5) << tube << ' ' << i;
        }
    }
}

TEST(CloudNormals, OfTwoSpheresApartBothFaceOutward)
{
    Draws draws(4);
    std::vector<Point3> places = random_sphere(3000, draws);
    const std::vector<Point3> other = moved(random_sphere(3000, draws), {9, -4, 2});
    places.insert(places.end(), other.begin(), other.end());
    const std::vector<Dir3> normals = normals_of(places);
    for (std::size_t i = 0; i < places.size(); ++i) {
        const Point3 centre = i < 3000 ? Point3{} : Point3{9, -4, 2};
        ASSERT_GT(dot(normals[i], places[i] - centre), 0.9) << i;
    }
}

TEST(CloudNormals, OfACubeAgreeAcrossItsEdges)
{
    Draws draws(5);
    std::vector<Point3> places;
    for (const double side : {-1.0, 1.0}) {
        for (const Point3 p : random_plane(2000, draws)) {
            places.insert(places.end(), {{p.x, p.y, side}, {p.x, side, p.y}, {side, p.x, p.y}});
        }
    }
    const std::vector<Dir3> normals = normals_of(places);
    for (std::size_t i = 0; i < places.size(); ++i) {
        ASSERT_GT(dot(normals[i], places[i] - Point3{}), 0.0) << i;
    }
}

TEST(CloudNormals, OfAnOpenHemisphereFaceOutwardAnyWayItOpens)
{
    Draws draws(6);
    for (int turn = 0; turn < 6; ++turn) {
        const Dir3 axis = draws.direction();
        std::vector<Point3> places = random_sphere(6000, draws);
        std::erase_if(places, [&](Point3 p) { return dot(p - Point3{}, axis) < 0.0; });
        const std::vector<Dir3> normals = normals_of(places);
        for (std::size_t i = 0; i < places.size(); ++i) {
            ASSERT_GT(dot(normals[i], places[i] - Point3{}), 0.8) << turn << ' ' << i;
        }
    }
}

TEST(CloudNormals, OfTerrainFaceTheSkyOverHillsAndHollows)
{
    for (const double sign : {1.0, -1.0}) {
        Draws draws(7);
        std::vector<Point3> places = random_plane(5000, draws);
        for (Point3& p : places) {
            p.z =
                sign * (0.4 * std::exp(-3.0 * (p.x * p.x + p.y * p.y)) + 0.05 * std::sin(9 * p.x));
        }
        for (const Dir3 n : normals_of(places)) { ASSERT_GT(n.z(), 0.2); }
    }
}

TEST(CloudNormals, OfAWallFaceThePositiveSideOfTheAxisAcrossIt)
{
    Draws draws(8);
    for (const double lean : {-0.3, 0.3}) {
        std::vector<Point3> places = random_plane(1000, draws);
        for (Point3& p : places) { p = {p.x, 3.0 + lean * p.x, p.y}; }
        for (const Dir3 n : normals_of(places)) { ASSERT_GT(n.y(), 0.9); }
    }
}

TEST(CloudNormals, OfARoomFaceAViewpointInside)
{
    Draws draws(9);
    std::vector<Point3> places = random_sphere(3000, draws);
    for (Point3& p : places) { p = {2.0 * p.x, p.y, p.z}; }
    const Point3 eye{1.0, 0.2, -0.1};
    const std::vector<Dir3> normals = normals_of(places, {false, eye});
    for (std::size_t i = 0; i < places.size(); ++i) {
        ASSERT_GT(dot(normals[i], eye - places[i]), 0.0) << i;
    }
}

/// The best plane through m = k + 1 points of noise sigma leans by sigma / sqrt(sum x^2) about
/// either axis. The k-th nearest is at R = s sqrt(k / pi) and the points fill the disc: sum x^2 =
/// m R^2 / 4. Both axes together: rms sigma sqrt(8 / m) / R.
TEST(CloudNormals, LeanAsMuchAsTheNoiseSays)
{
    constexpr std::size_t n = 20000;
    const double s = std::sqrt(4.0 / n);
    constexpr double k = Neighbours::most, m = k + 1;
    const double R = s * std::sqrt(k / std::numbers::pi);
    for (const double sigma : {0.02 * s, 0.1 * s}) {
        Draws draws(10);
        std::vector<Point3> places = random_plane(n, draws);
        for (Point3& p : places) { p.z = sigma * draws.gauss(); }
        double squares = 0.0;
        std::size_t inner = 0;
        const std::vector<Dir3> normals = normals_of(places);
        for (std::size_t i = 0; i < n; ++i) {
            ASSERT_GT(normals[i].z(), 0.0);
            if (std::max(std::abs(places[i].x), std::abs(places[i].y)) > 0.95) { continue; }
            squares += 1.0 - normals[i].z() * normals[i].z();
            ++inner;
        }
        const double expected = sigma * std::sqrt(8.0 / m) / R;
        const double measured = std::sqrt(squares / static_cast<double>(inner));
        EXPECT_GT(measured, 0.9 * expected);
        EXPECT_LT(measured, 1.25 * expected);  // discs are not evenly filled
    }
}

TEST(CloudNormals, AreTheSameBytesWithAnyNumberOfThreads)
{
    Draws draws(11);
    const Mesh cloud = cloud_of(random_sphere(20000, draws));
    const Surface one = prepared(cloud, {}, 1);
    for (const unsigned threads : {2U, 8U}) {
        const Surface more = prepared(cloud, {}, threads);
        EXPECT_TRUE(one.normals == more.normals);
        EXPECT_TRUE(one.spacing == more.spacing);
    }
}

TEST(CloudNormals, GoWithTheirPointsInAnyOrder)
{
    Draws draws(12);
    const std::vector<Point3> places = random_sphere(3000, draws);
    std::vector<std::size_t> order(places.size());
    std::iota(order.begin(), order.end(), 0U);
    std::shuffle(order.begin(), order.end(), std::mt19937(12));
    std::vector<Point3> shuffled(places.size());
    for (std::size_t i = 0; i < order.size(); ++i) { shuffled[i] = places[order[i]]; }
    const std::vector<Dir3> a = normals_of(places), b = normals_of(shuffled);
    for (std::size_t i = 0; i < order.size(); ++i) {
        ASSERT_GT(dot(a[order[i]], b[i]), 1.0 - 1e-12) << i;
    }
}

TEST(CloudNormals, ThereAreNoneWhereNeighboursSpanNoPlane)
{
    EXPECT_TRUE(normals_of({}).empty());
    EXPECT_EQ(without_direction(normals_of({{1, 2, 3}})), 1U);
    EXPECT_EQ(without_direction(normals_of({{1, 2, 3}, {4, 5, 6}})), 2U);
    EXPECT_EQ(without_direction(normals_of(std::vector<Point3>(50, {1, 2, 3}))), 50U);
    std::vector<Point3> line(40);
    for (int i = 0; i < 40; ++i) {
        line[static_cast<std::size_t>(i)] = Point3{1e6, 1, 1} + Vec3{0.1, 0.3, 0.7} * i;
    }
    EXPECT_EQ(without_direction(normals_of(line)), 40U);
    const std::vector<Dir3> triangle = normals_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    for (const Dir3 n : triangle) { EXPECT_GT(n.z(), 1.0 - 1e-12); }
}

TEST(CloudNormals, OfManyCopiesOfAPlaceTakeNoLongerThanOfOthers)
{
    // Quadratic time would be hours.
    Draws draws(20);
    std::vector<Point3> places = random_plane(1000, draws);
    places.resize(200'000, {0.25, 0.5, 0.0});
    const std::vector<Dir3> normals = normals_of(places);
    EXPECT_LT(without_direction(normals), 199'050U);
    EXPECT_GE(without_direction(normals), 199'000U);
    EXPECT_GT(normals[0].z(), 0.999);
}

TEST(CloudNormals, OfPointsFiledTwiceAreThoseOfTheSurface)
{
    Draws draws(13);
    std::vector<Point3> places = random_sphere(3000, draws);
    places.insert(places.end(), places.begin(), places.begin() + 3000);
    const std::vector<Dir3> normals = normals_of(places);
    for (std::size_t i = 0; i < places.size(); ++i) {
        ASSERT_GT(dot(normals[i], places[i] - Point3{}), 0.9) << i;
    }
}

TEST(CloudNormals, StayFiniteWithTheLargestAndTheSmallestCoordinates)
{
    Draws draws(14);
    for (const double size : {1e15, 1e-15, 1e-160, 1e-300}) {
        const Mesh cloud =
            test::moved(cloud_of(random_plane(200, draws)), test::upright(), size, {});
        for (const Dir3 n : prepared(cloud).normals) {
            ASSERT_TRUE(is_finite(Vec3(n)));
            ASSERT_TRUE(size < 1e-100 || n.z() > 0.999) << size;
        }
    }
}

TEST(CloudNormals, FiledOnesAreKeptUnlessEstimatesAreAskedFor)
{
    Draws draws(15);
    Mesh cloud = cloud_of(random_plane(500, draws));
    cloud.normals.assign(500, {0, 1, 1});
    cloud.normals[7] = {};
    const Surface filed = prepared(cloud);
    EXPECT_NEAR(filed.normals[3].y(), std::sqrt(0.5), 1e-12);
    EXPECT_EQ(filed.intake.normals_estimated, 0U);
    EXPECT_FALSE(filed.normals[7]);
    EXPECT_EQ(filed.intake.unlit_vertices, 1U);
    const Surface estimated = prepared(cloud, {true, {}});
    EXPECT_EQ(estimated.intake.normals_estimated, 500U);
    EXPECT_GT(estimated.normals[7].z(), 0.999);
}

TEST(AbsentPoints, AreUnlitAndChangeNothingForTheOthers)
{
    Draws draws(16);
    const std::vector<Point3> places = random_sphere(2000, draws);
    const Surface whole = prepared(cloud_of(places));
    Mesh cloud = cloud_of({});
    std::vector<std::size_t> at;  // of each of `places`
    for (const Point3 p : places) {
        while (draws.in(0, 1) < 0.4) {
            cloud.absent.push_back(static_cast<std::uint32_t>(cloud.positions.size()));
            cloud.positions.push_back(places[5]);
        }
        at.push_back(cloud.positions.size());
        cloud.positions.push_back(p);
    }
    const Surface sparse = prepared(cloud);
    ASSERT_GT(cloud.absent.size(), 500U);
    EXPECT_EQ(sparse.intake.absent_points, cloud.absent.size());
    EXPECT_EQ(sparse.intake.unlit_vertices, cloud.absent.size());
    EXPECT_EQ(sparse.intake.normals_estimated, places.size());
    for (const std::uint32_t i : cloud.absent) {
        ASSERT_FALSE(sparse.normals[i]);
        ASSERT_EQ(sparse.spacing[i], 0.0F);
    }
    for (std::size_t i = 0; i < places.size(); ++i) {
        ASSERT_GT(dot(whole.normals[i], sparse.normals[at[i]]), 1.0 - 1e-12);
        ASSERT_EQ(whole.spacing[i], sparse.spacing[at[i]]);
    }
    // With filed normals too, even where one is filed.
    cloud.normals.assign(cloud.positions.size(), {0, 0, 1});
    const Surface filed = prepared(cloud);
    EXPECT_EQ(filed.intake.unlit_vertices, cloud.absent.size());
    EXPECT_FALSE(filed.normals[cloud.absent[0]]);
}

TEST(CloudSpacing, IsOneOverTheRootOfTheDensity)
{
    Draws draws(17);
    constexpr std::size_t n = 20000;
    const std::vector<Point3> places = random_plane(n, draws);
    const Surface surface = prepared(cloud_of(places));
    double sum = 0.0;
    std::size_t inner = 0;
    for (std::size_t i = 0; i < n; ++i) {
        if (std::max(std::abs(places[i].x), std::abs(places[i].y)) > 0.95) { continue; }
        sum += static_cast<double>(surface.spacing[i]) * static_cast<double>(surface.spacing[i]);
        ++inner;
    }
    // pi d_8^2 / 8 has the mean 1/density: d_8^2 is the 8th arrival of a Poisson process.
    EXPECT_NEAR(sum / static_cast<double>(inner), 4.0 / n, 0.02 * 4.0 / n);
}

TEST(CloudSpacing, OfAStrayPointIsNoWiderThanThriceThatOfItsNeighbours)
{
    Draws draws(18);
    std::vector<Point3> places = random_plane(2000, draws);
    places.push_back({0.1, 0.2, 50.0});
    const Surface surface = prepared(cloud_of(places));
    EXPECT_LT(surface.spacing.back(), 4.0 * std::sqrt(4.0 / 2000.0));
    EXPECT_GT(surface.spacing.back(), 0.0F);
}

TEST(Leak, IsTheChanceThatNoDiscCoversAPlace)
{
    EXPECT_EQ(expected_leak(0.0), 1.0);
    EXPECT_EQ(expected_leak(1e9), 0.0);
    for (const double f : {0.5, 1.0}) {
        Draws draws(19);
        constexpr int trials = 400, points = 2500;
        const double size = std::sqrt(double{points});  // spacing 1
        int bare = 0;
        for (int t = 0; t < trials; ++t) {
            bool covered = false;
            for (int i = 0; i < points; ++i) {
                const double x = draws.in(-0.5, 0.5) * size, y = draws.in(-0.5, 0.5) * size;
                covered = covered || x * x + y * y < f * f;
            }
            bare += covered ? 0 : 1;
        }
        const double leak = expected_leak(f);
        EXPECT_NEAR(bare, trials * leak, 4.0 * std::sqrt(trials * leak * (1.0 - leak))) << f;
    }
}

}  // namespace
}  // namespace relight
