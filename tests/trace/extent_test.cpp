#include "core/trace/extent.h"

#include "tests/trace/model.h"

namespace relight {
namespace {

using namespace test;

TEST(OpenAbove, APlaneIsOpenHoweverItIsTurnedUntilSomethingStandsOnIt)
{
    for (const Frame& frame : {test::upright(), frame_around(normalize({1, 1, 0})),
                               frame_around(normalize({0.3, -0.5, 0.7}))}) {
        const Mesh floor = test::moved(test::grid(8), frame, 30.0, {1, 2, 3});
        const Mesh stone = test::moved(test::icosphere(1), frame, 0.01, {1, 2, 3});
        const Model alone(floor);
        const Model with_stone(test::joined(floor, stone));
        const double margin = alone.bvh.clearance(0.0).offset;
        for (std::size_t v = 0; v < floor.positions.size(); ++v) {
            const Point3 p = floor.positions[v];
            EXPECT_TRUE(alone.bvh.open_above(p, alone.surface.normals[v], margin));
            EXPECT_FALSE(alone.bvh.open_above(p - Vec3(frame.n), frame.n, margin));
            EXPECT_FALSE(with_stone.bvh.open_above(p, frame.n, margin));
        }
    }
}

TEST(OpenAbove, LightMetersThatNothingShadowsDoNotCount)
{
    Mesh mesh = test::grid(2);
    mesh.positions.push_back({0, 0, 5});  // used by no face
    EXPECT_TRUE(Model(mesh).bvh.open_above({0, 0, 0}, up, 1e-9));
    EXPECT_TRUE(Model(test::mesh_of({}, {})).bvh.open_above({0, 0, 0}, up, 0.0));
}

TEST(OpenAbove, IsNeverToldWhereACornerRisesByMoreThanTheMargin)
{
    Numbers numbers;
    std::size_t open = 0;
    for (std::size_t round = 0; round < 200; ++round) {
        std::vector<Point3> corners;
        const std::size_t triangles = 1 + round % 7;
        corners.reserve(3 * triangles);
        const double flatness = numbers.in(0.0, 1.0);
        for (std::size_t k = 0; k < 3 * triangles; ++k) {
            corners.push_back({numbers.in(-1, 1), numbers.in(-1, 1), flatness * numbers.in(-1, 1)});
        }
        std::vector<std::uint32_t> indices(corners.size());
        for (std::uint32_t i = 0; i < indices.size(); ++i) { indices[i] = i; }
        const Model model(test::moved(test::mesh_of(corners, indices),
                                      frame_around(numbers.direction()), 1.0, {10, 20, 30}));
        for (int k = 0; k < 200; ++k) {
            const Dir3 n = k % 2 == 0 ? numbers.direction() : model.surface.normals[0];
            const Point3 p{numbers.in(8, 12), numbers.in(18, 22), numbers.in(28, 32)};
            const double margin = numbers.in(0.0, 0.1);
            if (!n || !model.bvh.open_above(p, n, margin)) { continue; }
            ++open;
            for (const Point3 corner : model.mesh.positions) {
                EXPECT_LE(dot(corner - p, n), margin + 1e-12);
            }
        }
    }
    EXPECT_GT(open, 1000U);
}

TEST(ExtentReach, IsAsTightAsEachFavouredDirectionAllows)
{
    // dot(x, n) = dot(x, m) + dot(x, n - m) <= reach(m) + radius |n - m|, of either side of m.
    Numbers numbers;
    std::size_t told_by_one = 0;
    for (int round = 0; round < 300; ++round) {
        std::vector<Dir3> favoured;
        for (std::size_t k = 0; k < Extent::most_favoured; ++k) {
            favoured.push_back(numbers.direction());
        }
        Extent extent(favoured), of_lattice;
        double radius = 0.0;
        const double flatness = round % 2 == 0 ? 1e-3 : 1.0;
        const Frame frame = frame_around(favoured[0]);
        for (int k = 0; k < 20; ++k) {
            const Vec3 place = frame.to_world(
                {numbers.in(-1, 1), numbers.in(-1, 1), flatness * numbers.in(-1, 1)});
            extent.add(place);
            of_lattice.add(place);
            radius = std::max(radius, length(place));
        }
        for (const Dir3 m : favoured) {
            for (const double turn : {0.0, 1e-9, 1e-3, 0.03, 0.3}) {
                for (const double side : {-1.0, 1.0}) {
                    const Dir3 n = normalize(Vec3(m) * side + Vec3(numbers.direction()) * turn);
                    const double bound =
                        extent.reach(side > 0 ? m : -m) + radius * length(Vec3(n) - Vec3(m) * side);
                    EXPECT_LE(extent.reach(n), bound + 1e-12);
                    EXPECT_LE(extent.reach(n), of_lattice.reach(n));
                    told_by_one += extent.reach(n) < of_lattice.reach(n) ? 1 : 0;
                }
            }
        }
    }
    EXPECT_GT(told_by_one, 1000U);
}

TEST(OpenAbove, ADiscReachesAsFarAsItsTilt)
{
    Mesh cloud = test::grid(20);
    cloud.faces = {};
    for (const Dir3 normal : {up, normalize({1, 0, 1})}) {
        cloud.normals.assign(cloud.positions.size(), normal);
        const Model model(cloud);
        double rises = 0.0;
        for (const float s : model.surface.spacing) {
            rises =
                std::max(rises, 1.5 * static_cast<double>(s) * std::hypot(normal.x(), normal.y()));
        }
        EXPECT_TRUE(model.bvh.open_above({0, 0, 0}, up, rises + 1e-9));
        EXPECT_EQ(model.bvh.open_above({0, 0, 0}, up, 0.99 * rises), rises == 0.0);
    }
}

}  // namespace
}  // namespace relight
