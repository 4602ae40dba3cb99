// Columns of delta lights: vector code and streams against arrive(), vertex_receiver(),
// shadow_ray() and one ray at a time, bit by bit.
#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <random>

#include "core/transport/delta_rays.h"
#include "core/transport/receiver.h"
#include "core/transport/transport.h"
#include "tests/scenes.h"

namespace relight {
namespace {

/// A ball over a floor, and a vertex that no face uses.
Mesh ball_over_floor()
{
    Mesh mesh = test::joined(
        test::grid(24), test::moved(test::icosphere(3), test::upright(), 0.3, {0.1, 0.05, 0.6}));
    mesh.positions.push_back({0.3, 0.3, 0.3});
    return mesh;
}

Mesh ball_as_cloud()
{
    Mesh cloud = test::icosphere(4);
    cloud.faces = {};
    for (const Point3 p : cloud.positions) { cloud.normals.push_back(p - Point3{}); }
    return cloud;
}

std::vector<LightShape> delta_lights(Point3 at_vertex)
{
    const auto web = std::make_shared<const IesProfile>(
        IesProfile{{0.0, 45.0, 90.0}, {0.0}, {100.0, 60.0, 5.0}});
    const Dir3 down = normalize({0.1, 0.2, -1.0});
    const Dir3 across = normalize({1.0, 0.0, 0.1});
    return {PointLight{{0.5, -0.4, 1.5}, {}},
            PointLight{{0.5, -0.4, 1.5}, 1.7},
            PointLight{{1e9, 2e9, 1e9}, {}},
            PointLight{{1e140, 0, 1e140}, {}},  // its square is beyond double
            PointLight{at_vertex, {}},
            PointLight{at_vertex + Vec3{0, 0, 1e-12}, {}},
            SpotLight{{0.1, 0.2, 2.0}, down, 0.2, 0.5, {}},
            IesLight{{0.1, 0.2, 2.0}, down, across, web},
            DirectionalLight{normalize({1.0, 0.4, -0.35})}};
}

struct Expected {
    float E, visible;
};
Expected one_by_one(const Stage& stage, const Scene& scene, std::size_t v, std::uint64_t& rays)
{
    const TransportOptions& options = scene.transport;
    const Light& light = scene.lights[0];
    const Receiver receiver = vertex_receiver(stage, v);
    const Arrival arrival = arrive(light.shape, receiver.p);
    const double cos_n = dot(receiver.frame.n, arrival.wi);
    const double cos_i = options.two_sided ? std::abs(cos_n) : cos_n;
    if (!(cos_i > 0.0)) { return {0.0F, 0.0F}; }
    std::uint8_t blocked = 0;
    if (options.shadows) {
        const ShadowRay ray =
            shadow_ray(*stage.bvh, receiver, arrival.wi, arrival.distance, options);
        stage.bvh->occluded({&ray, 1}, {&blocked, 1});
        ++rays;
    }
    if (blocked != 0) { return {0.0F, 0.0F}; }
    return {static_cast<float>(cos_i * per_unit_m2(arrival, scene.length_unit_m)), 1.0F};
}

void expect_the_same(const Stage& stage, const Scene& scene)
{
    Progress progress;
    TransportWanted wanted;
    wanted.threads = 2;
    const auto column = trace(stage, scene, wanted, progress).columns[0];
    ASSERT_EQ(column->E.size(), stage.mesh->positions.size());
    std::uint64_t rays = 0;
    for (std::size_t v = 0; v < column->E.size(); ++v) {
        const Expected expected = one_by_one(stage, scene, v, rays);
        ASSERT_EQ(std::bit_cast<std::uint32_t>(column->E[v]),
                  std::bit_cast<std::uint32_t>(expected.E))
            << "vertex " << v << ", " << column->E[v] << " and " << expected.E;
        ASSERT_EQ(column->visible[v], expected.visible) << v;
    }
    EXPECT_EQ(column->rays, rays);
}

void expect_the_same_of_all_lights()
{
    for (const Mesh& mesh :
         {ball_over_floor(), ball_as_cloud(),
          test::moved(ball_over_floor(), test::upright(), 300.0, {1e6, 2e6, 7})}) {
        const Stage stage = test::staged(mesh);
        for (const LightShape& shape : delta_lights(stage.mesh->positions[100])) {
            for (const int options : {0, 1, 2, 3}) {
                Scene scene;
                scene.lights = {test::light_of(shape)};
                scene.length_unit_m = 0.37;
                scene.transport.two_sided = options == 1;
                if (options == 2) { scene.transport.max_distance = 0.45; }
                scene.transport.shadows = options != 3;
                SCOPED_TRACE("light " + std::to_string(shape.index()) + ", options " +
                             std::to_string(options));
                expect_the_same(stage, scene);
            }
        }
    }
}

TEST(DeltaColumn, IsOneRayAVertexToTheLastBit)
{
    expect_the_same_of_all_lights();
}

TEST(DeltaColumn, IsTheSameOnEveryInstructionSet)
{
    for (std::int64_t left = hwy::SupportedTargets() & HWY_TARGETS; left != 0; left &= left - 1) {
        const std::int64_t target = left & -left;
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(target);
        SCOPED_TRACE(hwy::TargetName(target));
        const Stage stage = test::staged(ball_over_floor());
        for (const LightShape& shape : delta_lights(stage.mesh->positions[100])) {
            Scene scene;
            scene.lights = {test::light_of(shape)};
            expect_the_same(stage, scene);
        }
        for (const bool distant : {false, true}) {
            DeltaGeometry light;
            light.distant = distant;
            light.place = {0.5, -0.4, 1.5};
            light.wi = normalize({1.0, 0.4, 0.35});
            light.box = stage.bvh->box();
            light.clearance = stage.bvh->clearance();
            RayFields::Field<float> E;
            EXPECT_TRUE(light_up(light, stage.surface->ordered, 0, 64, nullptr, E, nullptr))
                << "left to the plain loop; distant: " << distant;
        }
    }
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

/// Floats hide the last bits of what they are made of; doubles do not.
TEST(DeltaRays, AreThoseOfShadowRayToTheLastBitOfADouble)
{
    const Stage stage = test::staged(ball_over_floor());
    const Bvh& bvh = *stage.bvh;
    for (const Point3 place : {Point3{0.5, -0.4, 1.5}, {0.1, 0.05, 0.6}, {1e9, 2e9, 1e9}}) {
        const LightShape shape = PointLight{place, {}};
        DeltaGeometry light;
        light.place = place;
        light.length_unit_m = 0.37;
        light.reach = std::numeric_limits<double>::infinity();
        light.box = bvh.box();
        light.clearance = bvh.clearance();
        ShadowStream rays(bvh);
        RayFields::Field<float> E;
        const std::size_t count = std::min(ShadowStream::capacity, stage.surface->order.size());
        ASSERT_TRUE(light_up(light, stage.surface->ordered, 0, count, nullptr, E, &rays));
        std::size_t facing = 0;  // those take part, in their order
        for (std::size_t i = 0; i < count; ++i) {
            const Receiver receiver = vertex_receiver(stage, stage.surface->order[i]);
            const Arrival arrival = arrive(shape, receiver.p);
            ASSERT_EQ(std::signbit(E[i]), !(dot(receiver.frame.n, arrival.wi) > 0.0)) << i;
            if (std::signbit(E[i])) { continue; }
            const std::size_t k = facing++;
            ASSERT_LT(k, rays.size());
            const ShadowRay ray = shadow_ray(bvh, receiver, arrival.wi, arrival.distance, {});
            const RayFields& f = rays.fields();
            ASSERT_EQ((Point3{f.origin_x[k], f.origin_y[k], f.origin_z[k]}), ray.origin) << i;
            ASSERT_EQ((Vec3{f.direction_x[k], f.direction_y[k], f.direction_z[k]}),
                      Vec3(ray.direction))
                << i;
            ASSERT_EQ(f.from[k], ray.from) << i;
            ASSERT_EQ(f.distance[k], ray.distance) << i;
        }
        EXPECT_EQ(rays.size(), facing);
    }
}

TEST(DeltaColumn, OfAnyRangeIsThatPartOfTheWholeToTheLastBit)
{
    const Stage stage = test::staged(ball_over_floor());
    const std::size_t vertices = stage.mesh->positions.size();
    for (const LightShape& shape : delta_lights(stage.mesh->positions[100])) {
        for (const unsigned bounces : {0U, 1U}) {
            Scene scene;
            scene.lights = {test::light_of(shape)};
            scene.transport.bounces = bounces;
            scene.transport.samples = 2;
            Progress progress;
            const auto whole = trace(stage, scene, {}, progress).columns[0];
            ASSERT_EQ(whole->visible.bits.size(), (vertices + 63) / 64);
            for (const auto& [begin, end] :
                 {std::pair(std::size_t{0}, vertices), {1, 65}, {700, 701}, {5, 5}}) {
                const Column part = column(stage, scene, 0, begin, end);
                ASSERT_EQ(part.E.size(), end - begin);
                for (std::size_t v = begin; v < end; ++v) {
                    ASSERT_EQ(std::bit_cast<std::uint32_t>(part.E[v - begin]),
                              std::bit_cast<std::uint32_t>(whole->E[v]));
                    ASSERT_FALSE(std::signbit(whole->E[v]));
                    ASSERT_EQ(part.visible[v - begin], whole->visible[v]);
                }
            }
        }
    }
}

/// Of less than 1.2e-38 a float has no normal number: on threads of trace() that is 0.
TEST(DeltaColumn, OfAnyRangeIsThatPartOfTheWholeWhereTheLightIsTooFaint)
{
    const Stage stage = test::staged(ball_over_floor());
    Scene scene;
    scene.lights = {test::light_of(PointLight{{0, 0, 3e19}, {}})};
    Progress progress;
    const auto whole = trace(stage, scene, {}, progress).columns[0];
    const std::size_t vertices = stage.mesh->positions.size();
    const Column part = column(stage, scene, 0, 0, vertices);
    EXPECT_EQ(part.rays, whole->rays);
    for (std::size_t v = 0; v < vertices; ++v) {
        ASSERT_EQ(std::bit_cast<std::uint32_t>(part.E[v]),
                  std::bit_cast<std::uint32_t>(whole->E[v]))
            << v;
        ASSERT_EQ(part.visible[v], whole->visible[v]) << v;
    }
}

TEST(DeltaColumn, FollowsItsVerticesWhenTheyAreShuffled)
{
    const Mesh mesh = ball_over_floor();
    std::vector<std::uint32_t> to(mesh.positions.size());
    std::iota(to.begin(), to.end(), 0U);
    std::shuffle(to.begin(), to.end(), std::mt19937(3));
    Mesh shuffled = mesh;
    for (std::size_t v = 0; v < to.size(); ++v) { shuffled.positions[to[v]] = mesh.positions[v]; }
    for (auto& corner : shuffled.faces.indices) { corner = to[corner]; }
    const Stage a = test::staged(mesh), b = test::staged(shuffled);
    Scene scene;
    scene.lights = {test::light_of(PointLight{{0.5, -0.4, 1.5}, {}})};
    Progress progress;
    const auto of_a = trace(a, scene, {}, progress).columns[0];
    const auto of_b = trace(b, scene, {}, progress).columns[0];
    EXPECT_EQ(of_a->rays, of_b->rays);
    for (std::size_t v = 0; v < to.size(); ++v) {
        EXPECT_EQ(of_a->E[v], of_b->E[to[v]]) << v;
        EXPECT_EQ(of_a->visible[v], of_b->visible[to[v]]) << v;
    }
}

TEST(Columns, AllAreExpectedBeforeTheFirstIsMade)
{
    const Stage stage = test::staged(test::grid(20));
    Scene scene;
    scene.transport.samples = 4;
    scene.lights = {test::light_of(PointLight{{0.5, -0.4, 1.5}, {}}),
                    test::light_of(EnvironmentLight{}),
                    test::light_of(DirectionalLight{normalize({1.0, 0.4, -0.35})})};
    Progress progress;
    TransportWanted wanted;
    wanted.ambient_occlusion = true;
    std::vector<double> before;
    wanted.keep = [&](Told /*told*/, std::size_t light, const auto& make) {
        before.push_back(progress.fraction());
        return light == 2 ? std::make_shared<const Column>() : make();  // one was kept
    };
    trace(stage, scene, wanted, progress);
    EXPECT_EQ(before, (std::vector<double>{0.0, 0.25, 0.5, 0.75}));
    EXPECT_EQ(progress.fraction(), 1.0);
}

}  // namespace
}  // namespace relight
