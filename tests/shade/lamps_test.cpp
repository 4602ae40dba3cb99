// What paths ask of a light before they look at it.
#include <gtest/gtest.h>

#include "core/shade/world.h"
#include "tests/clouds.h"
#include "tests/shade/corner.h"

namespace relight {
namespace {

using test::Draws;
using test::light_of;

constexpr double pi = std::numbers::pi;

/// A light of a place and a size, and the ball that holds it.
struct Placed {
    LightShape shape;
    Point3 centre;
    double radius;
    Point3 (*on_rim)(const LightShape&, Draws&);  ///< where it ends, or turns away
};

/// Half of them its corners, which lie on the ball.
Point3 on_rim_of_rect(const LightShape& shape, Draws& draws)
{
    const auto& rect = std::get<RectLight>(shape);
    const auto end = [&] { return std::copysign(0.5, draws.in(-1, 1)); };
    const double u = end();
    const double v = draws.in(-1, 1) < 0.0 ? end() : draws.in(-0.5, 0.5);
    return rect.center + rect.edge_u * u + rect.edge_v * v;
}

Point3 on_rim_of_disk(const LightShape& shape, Draws& draws)
{
    const auto& disk = std::get<DiskLight>(shape);
    const double phi = draws.in(0.0, 2.0 * pi);
    const Vec3 aside = frame_around(disk.normal).to_world({std::cos(phi), std::sin(phi), 0.0});
    return disk.center + aside * disk.radius;
}

Point3 on_ball(const LightShape& shape, Draws& draws)
{
    const auto& ball = std::get<SphereLight>(shape);
    return ball.center + Vec3(draws.direction()) * ball.radius;
}

std::vector<Placed> placed_lights()
{
    const Point3 c{0.3, -1.2, 2.5};
    const Vec3 u{0.4, 0.1, -0.2}, v{0.1, 0.7, 0.3}, thin{1e-4, 2e-4, 0.0};
    std::vector<Placed> lights;
    for (const auto& [a, b] : {std::pair{u, v}, {v * -2.0, u}, {u, thin}, {u * 1e4, v * 1e4}}) {
        const double radius = 0.5 * std::max(length(a + b), length(a - b));
        for (const bool both : {false, true}) {
            lights.push_back({RectLight{c, a, b, both}, c, radius, on_rim_of_rect});
        }
    }
    for (const double radius : {1e-5, 0.4, 300.0}) {
        lights.push_back(
            {DiskLight{c, normalize({0.3, -0.5, 0.8}), radius}, c, radius, on_rim_of_disk});
        lights.push_back({SphereLight{c, radius}, c, radius, on_ball});
    }
    return lights;
}

Lamp lamp_of(const LightShape& shape)
{
    Scene scene;
    scene.lights = {light_of(shape)};
    return world_of({}, scene).lamps.at(0);
}

/// Near the light, in its ball, or as far as a million radii.
Point3 any_place(const Placed& light, Draws& draws)
{
    const double radii = std::pow(10.0, draws.in(-2.0, 6.0));
    return light.centre + Vec3(draws.direction()) * (radii * light.radius);
}

TEST(MayBeSeen, NeverSaysNoWhereALightOfAPlaceIsSeen)
{
    Draws draws(3);
    for (const Placed& light : placed_lights()) {
        const Lamp lamp = lamp_of(light.shape);
        ASSERT_FALSE(std::isinf(lamp.radius));
        int seen = 0, grazed = 0;
        for (int i = 0; i < 20000; ++i) {
            const Point3 p = any_place(light, draws);
            // Anywhere, at the rim, or beside it by no more than roundings.
            const Vec3 to_rim = light.on_rim(light.shape, draws) - p;
            const Vec3 beside = Vec3(draws.direction()) * (1e-14 * length(to_rim));
            const Dir3 wi = i % 4 == 0 ? draws.direction()
                            : i % 4 == 1
                                ? sample(light.shape, p, {draws.in(0, 1), draws.in(0, 1)}, 0.0).wi
                                : normalize(to_rim + beside);
            if (!wi || !(look(light.shape, p, wi).L.r > 0.0)) { continue; }
            ASSERT_TRUE(may_be_seen(lamp, p, wi)) << light.shape.index() << ' ' << i;
            ++seen;
            grazed += i % 4 > 1 ? 1 : 0;
        }
        EXPECT_GT(seen, 2000) << light.shape.index();
        EXPECT_GT(grazed, 100) << light.shape.index();
    }
}

TEST(MayBeSeen, SaysNoToDirectionsThatPassALightByOrLeaveIt)
{
    Draws draws(4);
    for (const Placed& light : placed_lights()) {
        const Lamp lamp = lamp_of(light.shape);
        for (int i = 0; i < 5000; ++i) {
            const Dir3 away = draws.direction();
            const double radii = std::pow(10.0, draws.in(0.1, 5.0));  // 1.26 and more
            const Point3 p = light.centre + Vec3(away) * (radii * light.radius);
            // Through a place a tenth of a radius and more outside of the ball, square to it.
            const Frame frame = frame_around(away);
            const double phi = draws.in(0.0, 2.0 * pi), miss = draws.in(1.1, 2.1);
            const Vec3 aside = frame.to_world({std::cos(phi), std::sin(phi), 0.0});
            // sin of the angle to the centre: miss / radii, if there is one
            const double sine = std::min(1.0, miss / radii);
            const Dir3 past = normalize(aside * sine - Vec3(away) * std::sqrt(1.0 - sine * sine));
            ASSERT_FALSE(may_be_seen(lamp, p, past)) << light.shape.index() << ' ' << i;
            ASSERT_FALSE(may_be_seen(lamp, p, away)) << light.shape.index() << ' ' << i;
        }
    }
}

TEST(MayBeSeen, SaysYesWithinTheBallWhateverTheDirection)
{
    Draws draws(5);
    for (const Placed& light : placed_lights()) {
        const Lamp lamp = lamp_of(light.shape);
        for (int i = 0; i < 1000; ++i) {
            const Point3 p =
                light.centre + Vec3(draws.direction()) * (draws.in(0.0, 0.999) * light.radius);
            ASSERT_TRUE(may_be_seen(lamp, p, draws.direction())) << light.shape.index();
        }
    }
}

TEST(MayBeSeen, SaysYesToLightsThatAreEverywhereAndToFaces)
{
    Draws draws(6);
    const Emitter face{{Point3{0, 0, 0}, Point3{1, 0, 0}, Point3{0, 1, 0}}, 0, Rgb::grey(1.0)};
    for (const LightShape& shape : std::initializer_list<LightShape>{
             EnvironmentLight{}, EnvironmentLight{test::patchwork(8, 4), 0.3},
             make_sky(normalize({0.5, 0.7, 0.3}), 3.0),
             DirectionalLight{normalize({0, -1, 0}), 0.01},
             MeshLight{std::make_shared<const EmitterTable>(std::vector<Emitter>{face})}}) {
        const Lamp lamp = lamp_of(shape);
        for (int i = 0; i < 1000; ++i) {
            const Point3 p =
                Point3{} + Vec3(draws.direction()) * std::pow(10.0, draws.in(0.0, 12.0));
            ASSERT_TRUE(may_be_seen(lamp, p, draws.direction())) << shape.index();
        }
    }
}

}  // namespace
}  // namespace relight
