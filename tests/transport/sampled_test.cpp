// Light that is drawn sample by sample: its value, and the error that it claims.
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "core/base/random.h"
#include "tests/scenes.h"
#include "tests/statistics.h"

namespace relight {
namespace {

using test::light_of;
using test::Meters;
using test::NormalisedErrors;
using test::staged;

constexpr double pi = std::numbers::pi;

Scene scene_of(std::vector<Light> lights, unsigned samples = 64)
{
    Scene scene;
    scene.lights = std::move(lights);
    scene.transport.samples = samples;
    return scene;
}

/// A half-plane x < 0 at height 1 over meters on the ground, a window of light above it.
struct Penumbra {
    RectLight window{{0.2, 0.1, 2.0}, {0, 1.6, 0}, {1.4, 0, 0}, false};  // shines down
    std::vector<Point3> places;
    std::vector<double> truth;

    Penumbra()
    {
        const Dir3 up = normalize({0, 0, 1});
        for (int i = 0; i < 12; ++i) {
            const Point3 p{-0.9 + 0.13 * i, 0.05 * i, 0};
            // Seen from p the edge cuts the window at x = p.x + (0 - p.x) 2.
            const double from = std::clamp(-p.x, -0.5, 0.9);
            const RectLight seen{{0.5 * (from + 0.9), 0.1, 2.0}, {0, 1.6, 0}, {0.9 - from, 0, 0}};
            places.push_back(p);
            truth.push_back(irradiance(seen, p, up));
        }
    }
    Mesh blocker() const
    {
        return test::mesh_of({{-1e2, -1e2, 1}, {0, -1e2, 1}, {0, 1e2, 1}, {-1e2, 1e2, 1}},
                             {0, 1, 2, 0, 2, 3});
    }
    Meters meters() const
    {
        return {blocker(), places, std::vector<Vec3>(places.size(), {0, 0, 1})};
    }
};

EnvironmentLight bright_sky()
{
    Image image{16, 8, std::vector<Rgbf>(std::size_t{16} * 8), {}};
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        const auto u = static_cast<float>(uniform(1, i, 0, 0));
        image.pixels[i] = {u, 0.5F + u * u, i == 37 ? 40.0F : 0.2F};
    }
    return {std::make_shared<const EnvironmentMap>(std::move(image)), 0.3};
}

std::vector<Light> every_sampled_light()
{
    return {light_of(RectLight{{0, 0, 3}, {0, 1, 0}, {1, 0, 0}, false}, {3, 2, 1}),
            light_of(DiskLight{{1, 0, 3}, normalize({-0.3, 0, -1}), 0.5}),
            light_of(SphereLight{{-1, 1, 2.5}, 0.4}),
            light_of(DirectionalLight{normalize({0.2, 0.4, -1}), 0.1}),
            light_of(EnvironmentLight{}),
            light_of(bright_sky()),
            light_of(make_sky(normalize({1, 1, 1}), 3.0), Rgb::grey(1e-5))};
}

Mesh ball_over_floor()
{
    return test::joined(test::moved(test::grid(12), test::upright(), 2.0, {}),
                        test::moved(test::icosphere(2), test::upright(), 0.4, {0.1, 0.2, 0.7}));
}

TEST(Sampled, TheTruthLiesInTheNinetyFivePercentBandNinetyFivePercentOfTheTime)
{
    const Penumbra penumbra;
    const Meters meters = penumbra.meters();
    for (const unsigned samples : {16U, 64U, 256U, 1024U}) {
        Scene scene = scene_of({light_of(penumbra.window)}, samples);
        int within = 0;
        int all = 0;
        for (std::uint64_t seed = 0; seed < 200; ++seed) {
            scene.transport.seed = seed;
            const Column column = meters.read(scene);
            for (std::size_t i = 0; i < penumbra.places.size(); ++i) {
                const double share =
                    penumbra.truth[i] /
                    irradiance(penumbra.window, penumbra.places[i], normalize({0, 0, 1}));
                if (share < 0.05 || share > 0.95) { continue; }  // nearly all rays agree there
                const double difference = static_cast<double>(column.E[i]) - penumbra.truth[i];
                const double error = static_cast<double>(column.standard_error[i]);
                within += std::abs(difference) <= 1.96 * error ? 1 : 0;
                ++all;
            }
        }
        EXPECT_GT(all, 1000);
        EXPECT_GE(within, 0.92 * all) << samples << " samples";
        EXPECT_LE(within, 0.98 * all) << samples << " samples";
    }
}

TEST(Sampled, SkiesAndBouncesClaimHonestErrorsToo)
{
    // Without a closed form the truth is the mean over many seeds.
    const Meters meters(ball_over_floor(), {{0.5, 0.4, 0}, {-0.6, 0.3, 0}, {0.1, 0.2, 0.1}},
                        {{0, 0, 1}, {0.3, 0, 1}, {0, 1, 1}});
    for (const Light& light :
         {light_of(bright_sky()), light_of(make_sky(normalize({1, 1, 1}), 3.0), Rgb::grey(1e-5)),
          light_of(PointLight{{0.5, -0.8, 2.5}, {}})}) {
        Scene scene = scene_of({light}, 256);
        scene.transport.bounces = 2;
        constexpr std::uint64_t seeds = 200;
        const auto total = [](const Column& c, std::size_t i) {
            return static_cast<double>(c.E[i * c.bands]) + static_cast<double>(c.E_bounced[3 * i]);
        };
        std::vector<Column> columns;
        for (std::uint64_t seed = 0; seed < seeds; ++seed) {
            scene.transport.seed = seed;
            columns.push_back(meters.read(scene));
        }
        int within = 0;
        const auto pairs = static_cast<double>(seeds * meters.count);
        for (std::size_t i = 0; i < meters.count; ++i) {
            double mean = 0.0;
            for (const Column& c : columns) { mean += total(c, i) / seeds; }
            for (const Column& c : columns) {
                const double error = static_cast<double>(c.standard_error[3 * i]);
                within += std::abs(total(c, i) - mean) <= 1.96 * error ? 1 : 0;
            }
        }
        EXPECT_GE(within, 0.92 * pairs) << light.shape.index();
        EXPECT_LE(within, 0.98 * pairs) << light.shape.index();
    }
}

TEST(Sampled, ErrorFallsAtLeastAsTheSquareRootOfTheSamples)
{
    const Penumbra penumbra;
    const Meters meters = penumbra.meters();
    double before = 0.0;
    for (const unsigned samples : {64U, 256U, 1024U, 4096U}) {
        Scene scene = scene_of({light_of(penumbra.window)}, samples);
        double squares = 0.0;
        for (std::uint64_t seed = 0; seed < 40; ++seed) {
            scene.transport.seed = seed;
            const Column column = meters.read(scene);
            for (std::size_t i = 0; i < penumbra.truth.size(); ++i) {
                const double d = static_cast<double>(column.E[i]) - penumbra.truth[i];
                squares += d * d;
            }
        }
        if (before > 0.0) { EXPECT_LT(std::sqrt(squares), 0.5 * std::sqrt(before)) << samples; }
        before = squares;
    }
}

TEST(Sampled, LightWithoutAnOccluderIsExactAndCostsNoRay)
{
    const Stage plane = staged(test::grid(8));
    const Stage ball = staged(test::icosphere(2));
    for (const Light& light : every_sampled_light()) {
        if (!closed_irradiance(light.shape, {}, normalize({0, 0, 1}))) { continue; }
        const Scene scene = scene_of({light});
        const Column open = column(plane, scene, 0, 0, plane.mesh->positions.size());
        EXPECT_EQ(open.rays, 0U);
        for (std::size_t v = 0; v < plane.mesh->positions.size(); ++v) {
            const double E = *closed_irradiance(light.shape, plane.mesh->positions[v],
                                                plane.surface->normals[v]);
            EXPECT_FLOAT_EQ(open.E[v], static_cast<float>(E));
            EXPECT_EQ(open.standard_error[v], 0.0F);
        }
        // A convex body is not in its own way: rays are asked, but nothing is noisy.
        const Column round = column(ball, scene, 0, 0, ball.mesh->positions.size());
        for (std::size_t v = 0; v < ball.mesh->positions.size(); ++v) {
            const double E =
                *closed_irradiance(light.shape, ball.mesh->positions[v], ball.surface->normals[v]);
            // (Where hardly any of the light is above the horizon hardly any ray asks for it.)
            EXPECT_NEAR(static_cast<double>(round.E[v]), E, 1e-6 * E + 2e-5);
            EXPECT_LE(static_cast<double>(round.standard_error[v]), 0.5 * E / 8.0 + 2e-4);
        }
    }
}

TEST(Sampled, ASkyOnAnOpenPlaneIsPiTimesItsRadiance)
{
    const Stage plane = staged(test::grid(4));
    Image white{8, 4, std::vector<Rgbf>(32, {2.0F, 2.0F, 2.0F}), {}};
    const EnvironmentLight image{std::make_shared<const EnvironmentMap>(std::move(white)), 0.0};
    for (const Light& light : {light_of(EnvironmentLight{}, Rgb::grey(2.0)), light_of(image)}) {
        const Scene scene = scene_of({light}, 1024);
        const Column sky = column(plane, scene, 0, 0, 25);
        for (std::size_t v = 0; v < 25; ++v) {
            const double E = light.power.r * static_cast<double>(sky.E[v * sky.bands]);
            const double error =
                light.power.r * static_cast<double>(sky.standard_error[v * sky.bands]);
            EXPECT_NEAR(E, 2.0 * pi, 1e-6);
            EXPECT_LE(error, 1e-12);
        }
    }
}

TEST(Sampled, WhatIsWhollyHiddenGetsExactlyNothing)
{
    Mesh roof = test::joined(test::grid(2), test::moved(test::box({-9, -9, 0.2}, {9, 9, 0.3}),
                                                        test::upright(), 1.0, {}));
    const Stage stage = staged(roof);
    for (const Light& light : every_sampled_light()) {
        if (std::holds_alternative<EnvironmentLight>(light.shape) ||
            std::holds_alternative<SkyLight>(light.shape)) {
            continue;  // seen under the roof's edge
        }
        const Column column = relight::column(stage, scene_of({light}), 0, 0, 9);
        EXPECT_EQ(*std::max_element(column.E.begin(), column.E.end()), 0.0F);
        EXPECT_EQ(*std::max_element(column.visible.share.begin(), column.visible.share.end()),
                  0.0F);
    }
}

TEST(Sampled, TheSameBytesOnAnyNumberOfThreads)
{
    const Stage stage = staged(ball_over_floor());
    Scene scene = scene_of(every_sampled_light(), 16);
    scene.transport.bounces = 1;
    scene.materials = {make_cook_torrance({})};
    TransportWanted wanted{true, true, true, 1};
    Progress progress;
    const Transport one = trace(stage, scene, wanted, progress);
    for (const unsigned threads : {2U, 5U}) {
        wanted.threads = threads;
        const Transport many = trace(stage, scene, wanted, progress);
        EXPECT_EQ(many.rays, one.rays);
        EXPECT_EQ(many.sky->sh, one.sky->sh);
        EXPECT_EQ(many.sky->ambient_occlusion, one.sky->ambient_occlusion);
        for (std::size_t l = 0; l < scene.lights.size(); ++l) {
            EXPECT_EQ(many.columns[l]->E, one.columns[l]->E);
            EXPECT_EQ(many.columns[l]->E_bounced, one.columns[l]->E_bounced);
            EXPECT_EQ(many.columns[l]->standard_error, one.columns[l]->standard_error);
            EXPECT_EQ(many.drawn[l]->Lo, one.drawn[l]->Lo);
        }
    }
}

TEST(Sampled, AnotherSeedIsAnotherDrawAndADuplicateVertexIsTheSame)
{
    const Penumbra penumbra;
    std::vector<Point3> twice = penumbra.places;
    twice.push_back(twice[4]);
    const Meters meters(penumbra.blocker(), twice, std::vector<Vec3>(twice.size(), {0, 0, 1}));
    Scene scene = scene_of({light_of(penumbra.window)});
    const Column a = meters.read(scene);
    EXPECT_EQ(a.E[4], a.E.back());
    EXPECT_EQ(meters.read(scene).E, a.E);
    scene.transport.seed = 1;
    EXPECT_NE(meters.read(scene).E, a.E);
}

TEST(Sampled, EachVertexStopsWhenItsOwnErrorIsReached)
{
    const Penumbra penumbra;
    const Meters meters = penumbra.meters();
    Scene scene = scene_of({light_of(penumbra.window, Rgb::grey(3.0))}, 65536);
    const double most = 3.0 * *std::max_element(penumbra.truth.begin(), penumbra.truth.end());
    std::uint64_t rays = 0;
    for (const double share : {0.05, 0.01, 0.002}) {
        scene.transport.target_standard_error = share * most;
        const Column column = meters.read(scene);
        EXPECT_GT(column.rays, rays);  // a finer target costs more
        rays = column.rays;
        EXPECT_LT(rays, std::uint64_t{65536} * penumbra.places.size() /
                            4);  // and less than all there are
        for (std::size_t i = 0; i < penumbra.truth.size(); ++i) {
            const double error = 3.0 * static_cast<double>(column.standard_error[i]);
            EXPECT_LE(error, share * most);
            EXPECT_NEAR(3.0 * static_cast<double>(column.E[i]), 3.0 * penumbra.truth[i],
                        5.0 * error + 1e-6);
        }
    }
}

TEST(Sampled, AShiningFaceLightsAsTheRectangleInItsPlace)
{
    const RectLight rect{{0, 0, 2}, {0, 1.2, 0}, {0.8, 0, 0}, false};
    Mesh faces = test::mesh_of({{-0.4, -0.6, 2}, {-0.4, 0.6, 2}, {0.4, 0.6, 2}, {0.4, -0.6, 2}},
                               {0, 1, 2, 0, 2, 3});
    std::vector<Emitter> emitters(2);
    for (std::size_t t = 0; t < 2; ++t) {
        for (std::size_t c = 0; c < 3; ++c) {
            emitters[t].corners[c] = faces.positions[faces.faces.indices[3 * t + c]];
        }
        emitters[t].primitive = static_cast<std::uint32_t>(t);
        emitters[t].L = {2, 1, 3};
    }
    const MeshLight light{std::make_shared<const EmitterTable>(emitters)};
    NormalisedErrors errors;
    const Meters meters(faces, {{0, 0, 0}, {1, 0.5, 0}, {0.1, 0, 1.99}, {0.3, 0.2, 2.5}},
                        {{0, 0, 1}, {0, 0.5, 1}, {0, 0, 1}, {0, 0, -1}});
    const Column column = meters.read(scene_of({light_of(light)}, 256));
    for (std::size_t i = 0; i < meters.count; ++i) {
        const std::size_t v = meters.first + i;
        const double E =
            irradiance(rect, meters.stage.mesh->positions[v], meters.stage.surface->normals[v]);
        for (std::size_t b = 0; b < 3; ++b) {
            const double L = std::array{2.0, 1.0, 3.0}[b];
            errors.add(static_cast<double>(column.E[3 * i + b]) - L * E,
                       static_cast<double>(column.standard_error[3 * i + b]), 1e-5 * E + 1e-9,
                       "meter " + std::to_string(i));
        }
    }
}

TEST(Sampled, ShiningFacesBelowTheHorizonGiveExactlyNothingButToReceiversOfBothSides)
{
    const Mesh faces = test::mesh_of({{-1, -1, 2}, {-1, 1, 2}, {1, 1, 2}}, {0, 1, 2});
    const auto& p = faces.positions;
    const MeshLight light{std::make_shared<const EmitterTable>(
        std::vector<Emitter>{{{p[0], p[1], p[2]}, 0, {2, 1, 3}}})};
    // Before its front: turned away, and half so, with a corner above the horizon.
    const Meters meters(faces, {{0, 0, 0}, {0, 0, 0}}, {{0, 0, -1}, {1, 0, -0.3}});
    for (const bool two_sided : {false, true}) {
        Scene scene = scene_of({light_of(light)}, 256);
        scene.transport.two_sided = two_sided;
        const Column column = meters.read(scene);
        EXPECT_EQ(column.E[0] > 0.0F, two_sided);
        EXPECT_EQ(column.standard_error[0] > 0.0F, two_sided);
        EXPECT_GT(column.E[3], 0.0F);
    }
}

TEST(Sampled, FixedRadianceIsTheSameAtEveryScaleOfTheWorld)
{
    const Mesh world = ball_over_floor();
    const Stage here = staged(world);
    for (const double k : {1e-3, 1e3}) {
        const Stage there = staged(test::moved(world, test::upright(), k, {}));
        const RectLight small{{0, 0, 3}, {0, 1, 0}, {1, 0, 0}, false};
        const RectLight large{{0, 0, 3 * k}, {0, k, 0}, {k, 0, 0}, false};
        Scene a = scene_of({light_of(small)});
        Scene b = scene_of({light_of(large)});
        a.transport.shadows = b.transport.shadows = false;
        const std::size_t n = world.positions.size();
        const Column at_a = column(here, a, 0, 0, n);
        const Column at_b = column(there, b, 0, 0, n);
        for (std::size_t v = 0; v < n; ++v) { EXPECT_NEAR(at_a.E[v], at_b.E[v], 1e-5F); }
    }
}

TEST(Sampled, TwoSidedReceiversAddTheLightOfBothSides)
{
    const Stage sheet = staged(test::grid(1));
    for (const double z : {2.0, -2.0}) {
        Scene scene = scene_of({light_of(SphereLight{{0.3, 0, z}, 0.5})});
        scene.transport.two_sided = true;
        const Column both = column(sheet, scene, 0, 0, 4);
        const double E = irradiance(SphereLight{{0.3, 0, 2.0}, 0.5}, sheet.mesh->positions[0],
                                    normalize({0, 0, 1}));
        EXPECT_NEAR(static_cast<double>(both.E[0]), E, 1e-6);
    }
    Scene sky = scene_of({light_of(EnvironmentLight{})});
    sky.transport.two_sided = true;
    EXPECT_NEAR(static_cast<double>(column(sheet, sky, 0, 0, 4).E[0]), 2.0 * pi, 1e-6);
}

TEST(Sampled, DegenerateLightsAndPlacesGiveFiniteNumbersThatAreNotNegative)
{
    const Stage stage = staged(ball_over_floor());
    const Point3 vertex = stage.mesh->positions[7];
    std::vector<Light> lights{light_of(RectLight{{0, 0, 1}, {}, {1, 0, 0}, false}),
                              light_of(RectLight{vertex, {0, 1, 0}, {1, 0, 0}, true}),
                              light_of(DiskLight{vertex, normalize({0, 0, -1}), 0.0}),
                              light_of(DiskLight{vertex, normalize({0, 0, 1}), 0.5}),
                              light_of(SphereLight{vertex, 0.0}),
                              light_of(SphereLight{{0.1, 0.2, 0.7}, 0.1}),  // inside the ball
                              light_of(SphereLight{{0, 0, 0}, 1e6}),        // around everything
                              light_of(SphereLight{{0, 0, 1e200}, 1.0}),
                              light_of(DirectionalLight{normalize({0, 0, -1}), 0.5 * pi}),
                              light_of(make_sky(normalize({0, -1, 0}), 2.0))};
    for (std::size_t l = 0; l < lights.size(); ++l) {
        Scene scene = scene_of({lights[l]}, 8);
        scene.transport.bounces = 1;
        const Column c = column(stage, scene, 0, 0, stage.mesh->positions.size());
        for (const auto* values : {&c.E, &c.E_bounced, &c.standard_error, &c.visible.share}) {
            for (const float x : *values) {
                EXPECT_TRUE(std::isfinite(x)) << "light " << l;
                EXPECT_GE(x, 0.0F) << "light " << l;
            }
        }
    }
}

TEST(SkyVisibility, IsWhatAConstantSkyGivesOverPiAndMaxDistanceBoundsIt)
{
    const Stage stage = staged(ball_over_floor());
    Scene scene = scene_of({light_of(EnvironmentLight{})}, 1024);
    Progress progress;
    TransportWanted wanted;
    wanted.ambient_occlusion = wanted.sh = true;
    const Transport sky = trace(stage, scene, wanted, progress);
    const Column& column = *sky.columns[0];
    for (std::size_t v = 0; v < stage.mesh->positions.size(); ++v) {
        const double E = static_cast<double>(column.E[v]);
        const double open = static_cast<double>(sky.sky->ambient_occlusion[v]);
        EXPECT_NEAR(open, E / pi, 0.03);
        // The constant term of the transfer is the same light: T_00 = AO pi Y_00.
        EXPECT_NEAR(static_cast<double>(sky.sky->sh[9 * v]), open * pi * 0.28209479, 1e-5);
    }
    scene.transport.max_distance = 1e-6;
    const Transport near = trace(stage, scene, wanted, progress);
    for (const float open : near.sky->ambient_occlusion) { EXPECT_EQ(open, 1.0F); }
}

TEST(SkyVisibility, TransferTimesALinearSkyIsItsIrradiance)
{
    // L = a + b (w . u) has coefficients of degree 0 and 1 alone, so nine are exact: in the open
    // E = pi a + 2 pi / 3 b (n . u).
    const Stage ball = staged(test::icosphere(2));
    Progress progress;
    TransportWanted wanted;
    wanted.sh = true;
    const Transport sky = trace(ball, scene_of({}, 1024), wanted, progress);
    const double a = 1.5;
    const double b = 0.7;
    const Vec3 u = normalize({1, -2, 0.5});
    const double y0 = 0.28209479177387814;
    const double y1 = 0.4886025119029199;
    const double L[4] = {a / y0, b * u.y / y1, b * u.z / y1, b * u.x / y1};
    for (std::size_t v = 0; v < ball.mesh->positions.size(); ++v) {
        double E = 0.0;
        for (std::size_t k = 0; k < 4; ++k) {
            E += L[k] * static_cast<double>(sky.sky->sh[9 * v + k]);
        }
        const double truth = pi * a + 2.0 * pi / 3.0 * b * dot(ball.surface->normals[v], u);
        EXPECT_NEAR(E, truth, 5e-3 * truth);
    }
}

}  // namespace
}  // namespace relight
