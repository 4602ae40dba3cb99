#include <cmath>
#include <functional>

#include "core/geometry/spacing.h"
#include "tests/clouds.h"
#include "tests/trace/model.h"

namespace relight {
namespace {

using test::cloud_of;
using test::Draws;
using test::Model;

constexpr double degree = std::numbers::pi / 180.0;

/// Points of [-1, 1]^2 on a grid of n x n cells, anywhere within theirs.
std::vector<Point3> jittered_plane(int n, Draws& draws)
{
    std::vector<Point3> places;
    for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
            places.push_back({-1.0 + 2.0 * (i + draws.in(0, 1)) / n,
                              -1.0 + 2.0 * (j + draws.in(0, 1)) / n, 0.0});
        }
    }
    return places;
}

TEST(Discs, OfAPlaneNeverShadowItUnderAnySun)
{
    const Frame tilt = frame_around(normalize({0.4, 0.3, 0.6}));
    for (const bool filed : {true, false}) {         // or estimated
        for (const bool as_float : {true, false}) {  // how the coordinates are filed
            for (const bool jittered : {true, false}) {
                Draws draws(21);
                Mesh cloud = cloud_of(jittered ? jittered_plane(60, draws)
                                               : test::random_plane(3600, draws));
                if (filed) { cloud.normals.assign(cloud.positions.size(), {0, 0, 1}); }
                cloud = test::moved(std::move(cloud), tilt, 3.0, {2e3, -5e3, 1e3});
                if (as_float) {
                    cloud.double_positions = false;
                    for (Point3& p : cloud.positions) {
                        p = {static_cast<float>(p.x), static_cast<float>(p.y),
                             static_cast<float>(p.z)};
                    }
                }
                const Model model(std::move(cloud));
                std::size_t shadowed = 0;
                for (const double elevation : {1.0, 2.0, 5.0, 20.0, 50.0, 90.0}) {
                    for (int k = 0; k < 5; ++k) {
                        const double azimuth = 2.0 * std::numbers::pi * (k + 0.1) / 5.0;
                        const double e = elevation * degree;
                        const Dir3 sun = normalize(
                            tilt.to_world({std::cos(e) * std::cos(azimuth),
                                           std::cos(e) * std::sin(azimuth), std::sin(e)}));
                        for (std::size_t v = 0; v < model.mesh.positions.size(); ++v) {
                            shadowed += model.blocked(model.from_vertex(v, sun)) ? 1 : 0;
                        }
                    }
                }
                EXPECT_EQ(shadowed, 0U) << filed << as_float << jittered;
            }
        }
    }
}

/// Share of upright rays that pass a random cloud whose discs are `radius_scale` spacings wide.
double leak(const Surface& surface, const Mesh& cloud, double radius_scale, int rays)
{
    const Bvh bvh(cloud, surface, radius_scale);
    Draws draws(23);
    std::vector<ShadowRay> up;
    up.reserve(static_cast<std::size_t>(rays));
    for (int i = 0; i < rays; ++i) {
        up.push_back({{draws.in(-0.8, 0.8), draws.in(-0.8, 0.8), -1.0}, test::up, 0.0, test::far});
    }
    std::vector<std::uint8_t> blocked(up.size());
    bvh.occluded(up, blocked);
    return static_cast<double>(std::count(blocked.begin(), blocked.end(), 0)) / rays;
}

TEST(Discs, LetThroughWhatARandomCoverageOfTheirDensityDoes)
{
    constexpr std::size_t n = 40000;
    Draws draws(22);
    Mesh cloud = cloud_of(test::random_plane(n, draws));
    cloud.normals.assign(n, {0, 0, 1});
    const Surface measured = Model::prepared(cloud);
    Surface even = measured;  // the spacing that the density has, everywhere
    even.spacing.assign(n, static_cast<float>(std::sqrt(4.0 / n)));
    for (const double f : {0.5, 1.0, 1.5}) {
        const double expected = expected_leak(f);
        // Rays through one hole are no independent draws: the number of holes, some s^2 / 8 f^2
        // large each, is what scatters.
        const double holes = expected * 0.64 * n * 8.0 * f * f;
        const double error = expected * (4.0 / std::sqrt(holes)) + 4e-5;
        EXPECT_NEAR(leak(even, cloud, f, 400'000), expected, error) << f;
        // Where the points are few the measured spacing is wide: never more light than expected.
        EXPECT_LT(leak(measured, cloud, f, 400'000), expected + error) << f;
    }
}

TEST(Discs, AreNoneWhereAPointIsAbsentOrHasNoNormal)
{
    Draws draws(24);
    Mesh cloud = cloud_of(test::random_plane(1000, draws));
    cloud.normals.assign(1000, {0, 0, 1});
    const auto is_kept = [](Point3 p) { return p.x < 0.0; };
    Mesh with_absent = cloud, with_zero = cloud;
    for (std::uint32_t i = 0; i < 1000; ++i) {
        if (is_kept(cloud.positions[i])) { continue; }
        with_absent.absent.push_back(i);
        with_zero.normals[i] = {};
    }
    for (const Mesh& mesh : {with_absent, with_zero}) {
        const Model model(mesh);
        for (int i = 0; i < 2000; ++i) {
            const Point3 from{draws.in(-0.9, 0.9), draws.in(-0.9, 0.9), -1.0};
            if (std::abs(from.x) < 0.25) { continue; }  // discs reach over the border
            ASSERT_EQ(model.blocked({from, test::up, 0.0, test::far}), from.x < 0.0) << from.x;
        }
    }
}

TEST(Discs, AStrayPointCastsNoShadowOnTheRest)
{
    Draws draws(25);
    Mesh cloud = cloud_of(test::random_plane(2000, draws));
    cloud.positions.push_back({0.0, 0.0, 3.0});
    cloud.normals.assign(2001, {0, 0, 1});
    const Model model(std::move(cloud));
    std::size_t shadowed = 0;
    for (std::size_t v = 0; v < 2000; ++v) {
        shadowed += model.blocked(model.from_vertex(v, test::up)) ? 1 : 0;
    }
    // Its disc is at most 4.5 spacings wide: a few tens of the points that lie one a spacing^2.
    EXPECT_LT(shadowed, 100U);
}

TEST(Discs, AlongARayAreAllThatItMeetsAndNoOthers)
{
    Draws draws(26);
    Mesh cloud = cloud_of(test::random_sphere(3000, draws));
    for (const Point3 p : cloud.positions) { cloud.normals.push_back(p - Point3{}); }
    cloud = test::moved(std::move(cloud), test::upright(), 10.0, {300, 20, 1});
    const Model model(std::move(cloud));
    std::size_t met = 0;
    for (int i = 0; i < 300; ++i) {
        const Point3 eye = Point3{300, 20, 1} + Vec3(draws.direction()) * 40.0;
        const Point3 aim = Point3{300, 20, 1} + Vec3(draws.direction()) * draws.in(0, 8);
        const ShadowRay ray{eye, normalize(aim - eye), 25.0, 45.0};
        std::vector<std::uint32_t> expected;
        for (std::uint32_t v = 0; v < model.mesh.positions.size(); ++v) {
            const Vec3 n = model.surface.normals[v];
            const double t = dot(model.mesh.positions[v] - eye, n) / dot(ray.direction, n);
            const double r = length(eye + Vec3(ray.direction) * t - model.mesh.positions[v]);
            const double R = 1.5 * static_cast<double>(model.surface.spacing[v]);
            if (t > ray.from && t < ray.distance && r < R) { expected.push_back(v); }
        }
        ASSERT_EQ(model.bvh.points_along(ray), expected) << i;
        met += expected.size();
    }
    EXPECT_GT(met, 1500U);
    const Model mesh(test::icosphere(2));
    EXPECT_TRUE(mesh.bvh.points_along({{0, 0, 5}, normalize({0, 0, -1}), 0, 10}).empty());
}

}  // namespace
}  // namespace relight
