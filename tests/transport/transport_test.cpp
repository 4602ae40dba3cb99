#include "core/transport/transport.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "core/base/random.h"
#include "tests/scenes.h"

namespace relight {
namespace {

using test::light_of;
using test::staged;

Scene scene_of(std::vector<Light> lights)
{
    Scene scene;
    scene.lights = std::move(lights);
    return scene;
}

Transport traced(const Stage& stage, const Scene& scene, unsigned threads = 2)
{
    Progress progress;
    TransportWanted wanted;
    wanted.threads = threads;
    return trace(stage, scene, wanted, progress);
}

/// Of the floor below, which come first.
constexpr std::size_t grid_vertices = 625;

/// A ball over a floor, lit from above and aside: shadows, back faces, penumbra-free edges.
Mesh ball_over_floor()
{
    return test::joined(test::moved(test::grid(24), test::upright(), 2.0, {}),
                        test::moved(test::icosphere(3), test::upright(), 0.4, {0.1, 0.2, 0.7}));
}

std::vector<Light> three_lights()
{
    return {light_of(PointLight{{0.5, -0.8, 2.5}, {}}, {3, 2, 1}),
            light_of(SpotLight{{-1, 1, 3}, normalize({0.3, -0.3, -1}), 0.2, 0.5}, Rgb::grey(20)),
            light_of(DirectionalLight{normalize({0.2, 0.4, -1})}, Rgb::grey(2))};
}

TEST(Transport, IsTheSameToTheBitOnAnyNumberOfThreads)
{
    const Stage stage = staged(ball_over_floor());
    const Scene scene = scene_of(three_lights());
    const Transport one = traced(stage, scene, 1);
    for (const unsigned threads : {2U, 8U}) {
        const Transport many = traced(stage, scene, threads);
        EXPECT_EQ(many.rays, one.rays);
        for (std::size_t l = 0; l < 3; ++l) {
            EXPECT_EQ(many.columns[l]->E, one.columns[l]->E);
            EXPECT_EQ(many.columns[l]->visible, one.columns[l]->visible);
        }
    }
}

TEST(Transport, AnyRangeOfVerticesGivesThatPartOfTheColumn)
{
    const Stage stage = staged(ball_over_floor());
    Scene scene = scene_of(three_lights());
    scene.lights.push_back(light_of(SphereLight{{0.5, -0.8, 2.5}, 0.5}));
    scene.transport.bounces = 1;
    scene.transport.samples = 16;
    const std::size_t n = stage.mesh->positions.size();
    for (std::size_t l = 0; l < scene.lights.size(); ++l) {
        const Column whole = column(stage, scene, l, 0, n);
        const Column part = column(stage, scene, l, 100, 333);
        EXPECT_TRUE(std::equal(part.E.begin(), part.E.end(), whole.E.begin() + 100));
        EXPECT_TRUE(std::equal(part.E_bounced.begin(), part.E_bounced.end(),
                               whole.E_bounced.begin() + 300));
    }
}

TEST(Transport, ABallCastsAShadowOnTheFloorAndItsBackIsDark)
{
    const Stage stage = staged(ball_over_floor());
    const Transport transport =
        traced(stage, scene_of({light_of(PointLight{{0.1, 0.2, 3.0}, {}})}));
    const Column& column = *transport.columns[0];
    const std::size_t floor = grid_vertices;
    for (std::size_t v = 0; v < stage.mesh->positions.size(); ++v) {
        const Point3 p = stage.mesh->positions[v];
        if (v < floor) {  // the cone that touches the ball: tan = 0.4 / sqrt(2.3^2 - 0.4^2)
            const double from_axis = std::hypot(p.x - 0.1, p.y - 0.2);
            const double edge = 3.0 * 0.4 / std::sqrt(2.3 * 2.3 - 0.4 * 0.4);
            if (from_axis < 0.97 * edge) { EXPECT_EQ(column.E[v], 0.0F) << from_axis; }
            if (from_axis > 1.01 * edge) { EXPECT_EQ(column.visible[v], 1.0F) << from_axis; }
        } else if (p.z < 0.7) {
            EXPECT_EQ(column.E[v], 0.0F);
        }
    }
}

TEST(Transport, ReorderedVerticesGetTheSameLight)
{
    const Mesh mesh = ball_over_floor();
    std::vector<std::uint32_t> order(mesh.positions.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(), [](std::uint32_t a, std::uint32_t b) {
        return uniform(1, a, 0, 0) < uniform(1, b, 0, 0);
    });
    Mesh shuffled = mesh;
    std::vector<std::uint32_t> place(order.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) {
        shuffled.positions[i] = mesh.positions[order[i]];
        place[order[i]] = i;
    }
    for (std::uint32_t& corner : shuffled.faces.indices) { corner = place[corner]; }
    Scene scene = scene_of(three_lights());
    scene.lights.push_back(light_of(SphereLight{{0.5, -0.8, 2.5}, 0.5}));  // drawn by samples
    scene.transport.samples = 16;
    const Transport a = traced(staged(mesh), scene);
    const Transport b = traced(staged(shuffled), scene);
    for (std::size_t l = 0; l < scene.lights.size(); ++l) {
        for (std::size_t i = 0; i < order.size(); ++i) {
            EXPECT_EQ(b.columns[l]->E[i], a.columns[l]->E[order[i]]);
        }
    }
}

/// Largest difference of two columns over the largest value, at vertices seen alike; and how many
/// are not seen alike (rays that graze an edge may fall on either side).
struct Difference {
    double largest = 0.0;
    std::size_t seen_differently = 0;
};
Difference compare(const Column& a, const Column& b, double b_scale = 1.0)
{
    Difference d;
    const double most = static_cast<double>(*std::max_element(a.E.begin(), a.E.end()));
    for (std::size_t v = 0; v < a.E.size(); ++v) {
        if (a.visible[v] != b.visible[v]) {
            ++d.seen_differently;
            continue;
        }
        d.largest = std::max(
            d.largest,
            std::abs(static_cast<double>(a.E[v]) - b_scale * static_cast<double>(b.E[v])) / most);
    }
    return d;
}

std::vector<Light> moved(std::vector<Light> lights, const Frame& turn, double scale, Vec3 shift)
{
    const auto place = [&](Point3 p) {
        return Point3{} + turn.to_world(p - Point3{}) * scale + shift;
    };
    const auto aim = [&](Dir3 d) { return normalize(turn.to_world(d)); };
    for (Light& light : lights) {
        if (auto* point = std::get_if<PointLight>(&light.shape)) {
            point->position = place(point->position);
        } else if (auto* spot = std::get_if<SpotLight>(&light.shape)) {
            spot->position = place(spot->position);
            spot->axis = aim(spot->axis);
        } else if (auto* sun = std::get_if<DirectionalLight>(&light.shape)) {
            sun->travel = aim(sun->travel);
        }
    }
    return lights;
}

TEST(Transport, MovingTheWorldByTenMillionChangesNothingButRounding)
{
    const Vec3 shift{1e7, -1e7, 1e7};
    const Transport here = traced(staged(ball_over_floor()), scene_of(three_lights()));
    const Transport there =
        traced(staged(test::moved(ball_over_floor(), test::upright(), 1.0, shift)),
               scene_of(moved(three_lights(), test::upright(), 1.0, shift)));
    for (std::size_t l = 0; l < 3; ++l) {
        const Difference d = compare(*here.columns[l], *there.columns[l]);
        EXPECT_LT(d.largest, 1e-6);
        EXPECT_LE(d.seen_differently,
                  1U);  // coordinates there are steps of 2e-9: one ray grazes the ball
    }
}

TEST(Transport, TurningTheWorldChangesNothingButRounding)
{
    const Frame turn = frame_around(normalize({1, 2, -2}));
    const Transport a = traced(staged(ball_over_floor()), scene_of(three_lights()));
    const Transport b = traced(staged(test::moved(ball_over_floor(), turn, 1.0, {})),
                               scene_of(moved(three_lights(), turn, 1.0, {})));
    for (std::size_t l = 0; l < 3; ++l) {
        const Difference d = compare(*a.columns[l], *b.columns[l]);
        EXPECT_LT(d.largest, 1e-6);
        EXPECT_LE(d.seen_differently, 2U);
    }
}

TEST(Transport, LengthsTimesKGiveOneOverKSquaredOfPointLightAndTheSameSun)
{
    for (const double k : {1e-3, 1e3}) {
        const Transport a = traced(staged(ball_over_floor()), scene_of(three_lights()));
        const Transport b = traced(staged(test::moved(ball_over_floor(), test::upright(), k, {})),
                                   scene_of(moved(three_lights(), test::upright(), k, {})));
        for (std::size_t l = 0; l < 3; ++l) {
            const Difference d = compare(*a.columns[l], *b.columns[l], l < 2 ? k * k : 1.0);
            EXPECT_LT(d.largest, 1e-6);
            EXPECT_EQ(d.seen_differently, 0U);
        }
    }
}

TEST(Transport, ALengthUnitOfAMillimetreIsTheSameAsScalingTheFile)
{
    const Stage stage = staged(ball_over_floor());
    Scene metres = scene_of(three_lights());
    Scene millimetres = metres;
    millimetres.length_unit_m = 1e-3;
    const Transport a = traced(stage, metres);
    const Transport b = traced(stage, millimetres);
    EXPECT_LT(compare(*a.columns[0], *b.columns[0], 1e-6).largest, 1e-6);
    EXPECT_EQ(a.columns[2]->E, b.columns[2]->E);
}

TEST(Transport, LightsThatAreOffOrCastNoShadowCostNoRay)
{
    const Stage stage = staged(ball_over_floor());
    Scene scene = scene_of(three_lights());
    scene.lights[0].enabled = false;
    scene.lights[1].cast_shadows = false;
    const Transport transport = traced(stage, scene);
    EXPECT_EQ(transport.columns[0], nullptr);
    EXPECT_EQ(transport.columns[1]->rays, 0U);
    EXPECT_GT(transport.columns[2]->rays, 0U);
    scene.transport.shadows = false;
    EXPECT_EQ(traced(stage, scene).rays, 0U);
}

TEST(Transport, OnlyReceiversThatFaceTheLightCostARay)
{
    const Stage stage = staged(test::icosphere(3));
    const Transport transport =
        traced(stage, scene_of({light_of(DirectionalLight{normalize({0, 0, -1})})}));
    std::uint64_t facing = 0;
    for (const Dir3 n : stage.surface->normals) { facing += n.z() > 0.0 ? 1 : 0; }
    EXPECT_EQ(transport.rays, facing);
}

TEST(Transport, TwoSidedReceiversTakeLightFromBehindAndStillCastShadows)
{
    Mesh sheet = test::grid(4);
    Scene scene = scene_of({light_of(DirectionalLight{normalize({0, 0, 1})})});  // from below
    const Stage stage = staged(sheet);
    EXPECT_EQ(traced(stage, scene).columns[0]->E[0], 0.0F);
    scene.transport.two_sided = true;
    EXPECT_FLOAT_EQ(traced(stage, scene).columns[0]->E[0], 1.0F);
}

TEST(Transport, OccludersBeyondMaxDistanceLetLightPass)
{
    const Mesh roof =
        test::joined(test::grid(4), test::moved(test::grid(1), test::upright(), 3.0, {0, 0, 5}));
    Scene scene = scene_of({light_of(DirectionalLight{normalize({0, 0, -1})})});
    const Stage stage = staged(roof);
    EXPECT_EQ(traced(stage, scene).columns[0]->E[12], 0.0F);
    scene.transport.max_distance = 4.0;
    EXPECT_EQ(traced(stage, scene).columns[0]->E[12], 1.0F);
    scene.lights = {light_of(PointLight{{0, 0, 9}, {}})};
    EXPECT_GT(traced(stage, scene).columns[0]->E[12], 0.0F);
    scene.transport.max_distance = 6.0;
    EXPECT_EQ(traced(stage, scene).columns[0]->E[12], 0.0F);
}

TEST(Transport, ALampThatTouchesAWallIsNotHiddenByIt)
{
    // A wall x = 1 beside the floor, the lamp in its plane, at places of no special rounding.
    const Frame up = frame_around(normalize({-1, 0, 0}));
    const Mesh room = test::joined(test::grid(6), test::moved(test::grid(2), up, 2.0, {1.1, 0, 1}));
    const Stage stage = staged(room);
    for (int i = 0; i < 50; ++i) {
        const auto index = static_cast<std::uint64_t>(i);
        const Point3 lamp{1.1, 2.0 * uniform(3, index, 0, 0) - 1.0, 0.2 + uniform(3, index, 0, 1)};
        const Transport transport = traced(stage, scene_of({light_of(PointLight{lamp, {}})}));
        for (std::size_t v = 0; v < 49; ++v) { EXPECT_EQ(transport.columns[0]->visible[v], 1.0F); }
    }
}

TEST(Transport, ALightInTheMeshOrAtAVertexOrAbsurdlyFarGivesFiniteNumbers)
{
    const Stage stage = staged(ball_over_floor());
    const Point3 vertex = stage.mesh->positions[3];
    for (const Point3 p : {Point3{0.1, 0.2, 0.7}, vertex, Point3{0, 0, 0}, Point3{0, 0, 1e200},
                           Point3{1e-300, 0, 1e-300}, vertex + Vec3{0, 0, 1e-9}}) {
        const Transport transport = traced(stage, scene_of({light_of(PointLight{p, {}})}));
        for (const float e : transport.columns[0]->E) {
            EXPECT_TRUE(std::isfinite(e));
            EXPECT_GE(e, 0.0F);
        }
    }
    // Inside the closed ball its light reaches nothing outside.
    const Transport inside = traced(stage, scene_of({light_of(PointLight{{0.1, 0.2, 0.7}, {}})}));
    EXPECT_EQ(*std::max_element(inside.columns[0]->E.begin(), inside.columns[0]->E.end()), 0.0F);
}

TEST(Transport, ACloudOfTheBallCastsTheBallsShadow)
{
    Mesh ball = test::moved(test::icosphere(4), test::upright(), 0.4, {0.1, 0.2, 0.7});
    Mesh cloud = test::joined(test::moved(test::grid(24), test::upright(), 2.0, {}), ball);
    cloud.faces = {};
    for (std::size_t v = 0; v < cloud.positions.size(); ++v) {
        cloud.normals.push_back(v < grid_vertices ? Vec3{0, 0, 1}
                                                  : cloud.positions[v] - Point3{0.1, 0.2, 0.7});
    }
    const Transport transport =
        traced(staged(cloud), scene_of({light_of(PointLight{{0.1, 0.2, 3.0}, {}})}));
    for (std::size_t v = 0; v < grid_vertices; ++v) {
        const double from_axis = std::hypot(cloud.positions[v].x - 0.1, cloud.positions[v].y - 0.2);
        if (from_axis < 0.4) { EXPECT_EQ(transport.columns[0]->visible[v], 0.0F) << from_axis; }
        if (from_axis > 0.65) { EXPECT_EQ(transport.columns[0]->visible[v], 1.0F) << from_axis; }
    }
}

TEST(Transport, WorkStopsWhenAsked)
{
    const Stage stage = staged(ball_over_floor());
    Progress progress;
    progress.stop();
    const Transport transport = trace(stage, scene_of(three_lights()), {}, progress);
    EXPECT_EQ(transport.rays, 0U);
}

}  // namespace
}  // namespace relight
