#include "tests/trace/model.h"

namespace relight {
namespace {

using namespace test;

/// A few hundred directions all around.
std::vector<Dir3> directions(int count)
{
    std::vector<Dir3> all;
    for (int i = 0; i < count; ++i) {  // a spherical Fibonacci lattice
        const double z = 1.0 - (2.0 * i + 1.0) / count;
        const double phi = 2.0 * std::numbers::pi * i / std::numbers::phi;
        const double r = std::sqrt(1.0 - z * z);
        all.push_back(normalize({r * std::cos(phi), r * std::sin(phi), z}));
    }
    return all;
}

std::size_t false_shadows(const Model& model, int direction_count)
{
    std::size_t wrong = 0;
    std::vector<ShadowRay> rays;
    for (const Dir3 wi : directions(direction_count)) {
        for (std::size_t v = 0; v < model.mesh.positions.size(); ++v) {
            if (dot(model.surface.normals[v], wi) > 1e-6) {
                rays.push_back(model.from_vertex(v, wi));
            }
        }
    }
    std::vector<std::uint8_t> blocked(rays.size());
    model.bvh.occluded(rays, blocked);
    for (const std::uint8_t b : blocked) { wrong += b; }
    return wrong;
}

TEST(Bvh, AConvexMeshNeverShadowsItsOwnFrontAtAnySizeOrPlace)
{
    const Frame tilt = frame_around(normalize({0.3, -0.5, 0.7}));
    for (const Mesh& shape : {test::icosphere(4), test::latlong_sphere(40, 80),
                              test::box({-1, -1, -1}, {1, 1, 1}), test::icosphere(0)}) {
        for (const double size : {1e-3, 1.0, 1e5}) {
            for (const double shift : {0.0, 1e7}) {
                const Model model(test::moved(shape, tilt, size, {shift, -shift, 0.5 * shift}));
                EXPECT_EQ(false_shadows(model, 40), 0U)
                    << shape.positions.size() << " vertices, size " << size << ", shift " << shift;
            }
        }
    }
}

TEST(Bvh, CoordinatesFiledAsFloatFarFromTheOriginDoNotShadowTheirOwnRoughness)
{
    for (const double size : {1e5, 1e3, 1e2}) {
        Mesh ball = test::moved(test::icosphere(5), test::upright(), size, {1e7, 2e7, -1e7});
        for (Point3& p : ball.positions) {  // as a float file holds them: in steps of 1 or 2
            p = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
        }
        ball.double_positions = false;
        EXPECT_EQ(false_shadows(Model(ball), 40), 0U) << size;
    }
}

TEST(Bvh, AFlatGridIsNeverInItsOwnShadowDownToTheHorizon)
{
    for (const int n : {1, 7, 100}) {
        const Model model(
            test::moved(test::grid(n), frame_around(normalize({1, 2, 3})), 30.0, {5, 6, 7}));
        const Frame frame = frame_around(normalize({1, 2, 3}));
        for (const double elevation : {1e-4, 1e-3, 0.1, 1.5}) {
            const Dir3 wi =
                normalize(frame.to_world({std::cos(elevation), 0.0, std::sin(elevation)}));
            for (std::size_t v = 0; v < model.mesh.positions.size(); ++v) {
                ASSERT_FALSE(model.blocked(model.from_vertex(v, wi))) << n << " " << elevation;
            }
        }
    }
}

TEST(Bvh, TheFarSideOfASphereIsDark)
{
    const Model model(test::icosphere(4));
    const Dir3 wi = normalize({1, 2, 3});
    for (std::size_t v = 0; v < model.mesh.positions.size(); ++v) {
        // A receiver there that looked anyway (two-sided) meets the sphere itself.
        if (dot(model.surface.normals[v], wi) < -0.05) {
            EXPECT_TRUE(model.blocked(model.from_vertex(v, wi)));
        }
    }
}

TEST(Bvh, AWallOfTenOffsetsLeaksNothing)
{
    const Mesh floor = test::grid(10);
    const Model alone(floor);
    const double offset = alone.bvh.clearance(0.2).offset;
    // A second sheet ten offsets above the floor.
    Mesh lid = test::moved(test::grid(3), test::upright(), 1.2, {0, 0, 10.0 * offset});
    const Model model(test::joined(floor, lid));
    for (std::size_t v = 0; v < floor.positions.size(); ++v) {
        EXPECT_TRUE(model.blocked(model.from_vertex(v, normalize({0.1, 0.2, 1.0}))));
    }
}

TEST(Bvh, OccludersBeyondTheLightDoNotCountAndThoseBeforeItDo)
{
    const Model model(test::moved(test::grid(1), test::upright(), 1.0, {0, 0, 2}));
    const ShadowRay beyond{{0.1, 0.2, 0}, normalize({0, 0, 1}), 0.0, 1.9};
    const ShadowRay before{{0.1, 0.2, 0}, normalize({0, 0, 1}), 0.0, 2.1};
    const ShadowRay behind{{0.1, 0.2, 0}, normalize({0, 0, -1}), 0.0, far};
    EXPECT_FALSE(model.blocked(beyond));
    EXPECT_TRUE(model.blocked(before));
    EXPECT_FALSE(model.blocked(behind));
}

TEST(Bvh, ScalingByAThousandChangesNoShadow)
{
    const Mesh scene = test::joined(
        test::grid(20), test::moved(test::icosphere(2), test::upright(), 0.3, {0.1, 0.05, 0.6}));
    std::vector<std::vector<bool>> seen;
    for (const double scale : {1e-3, 1.0, 1e3}) {
        const Model model(test::moved(scene, test::upright(), scale, {}));
        auto& answers = seen.emplace_back();
        for (const Dir3 wi : directions(12)) {
            for (std::size_t v = 0; v < model.mesh.positions.size(); ++v) {
                if (dot(model.surface.normals[v], wi) < 1e-6) { continue; }
                answers.push_back(model.blocked(model.from_vertex(v, wi)));
            }
        }
    }
    EXPECT_EQ(seen[0], seen[1]);
    EXPECT_EQ(seen[2], seen[1]);
}

TEST(Bvh, ACloudOfASphereDoesNotShadowItsOwnFrontAndDarkensItsBack)
{
    Mesh cloud = test::icosphere(4);
    cloud.faces = {};
    for (const Point3 p : cloud.positions) { cloud.normals.push_back(p - Point3{}); }
    const Model model(cloud);
    EXPECT_EQ(false_shadows(model, 40), 0U);
    const Dir3 wi = normalize({1, 2, 3});
    std::size_t dark = 0;
    std::size_t back = 0;
    for (std::size_t v = 0; v < cloud.positions.size(); ++v) {
        if (dot(model.surface.normals[v], wi) > -0.3) { continue; }
        ++back;
        dark += model.blocked(model.from_vertex(v, wi)) ? 1 : 0;
    }
    EXPECT_GE(static_cast<double>(dark), 0.99 * static_cast<double>(back));
}

TEST(Bvh, NearestGivesThePlaceOnTheTriangleInDouble)
{
    const Mesh far_away = test::moved(test::grid(4), test::upright(), 1.0, {1e6, 0, 0});
    const Model model(far_away);
    const Point3 eye{1e6 + 0.3, 0.2, 1e5};
    const Hit hit = model.bvh.nearest(eye, normalize({0, 0, -1}));
    ASSERT_NE(hit.primitive, ~0U);
    EXPECT_NEAR(hit.distance, 1e5, 1e-9);
    const Triangle& t = model.surface.triangles[hit.primitive];
    const Point3 a = model.mesh.positions[t[0]];
    const Point3 p =
        a + (model.mesh.positions[t[1]] - a) * hit.u + (model.mesh.positions[t[2]] - a) * hit.v;
    EXPECT_NEAR(p.x, eye.x, 1e-9);
    EXPECT_NEAR(p.y, eye.y, 1e-9);
    EXPECT_EQ(model.bvh.nearest(eye, normalize({0, 1, 0})).primitive, ~0U);
}

TEST(Bvh, OfOnePointOrNothingAtAllIsEmptyNotFatal)
{
    const Model one(test::mesh_of({{1, 2, 3}}, {}));
    EXPECT_FALSE(one.blocked({{0, 0, 0}, normalize({1, 2, 3}), 0.0, far}));
    const Model same(test::mesh_of({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {0, 1, 2}));
    EXPECT_FALSE(same.blocked({{0, 0, 0}, normalize({1, 2, 3}), 0.0, far}));
}

}  // namespace
}  // namespace relight
