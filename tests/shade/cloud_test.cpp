#include <gtest/gtest.h>

#include <cmath>

#include "core/light/environment.h"
#include "tests/clouds.h"
#include "tests/shade/pictures.h"

namespace relight {
namespace {

using test::cloud_of;
using test::Draws;
using test::light_of;
using test::picture;
using test::staged;

Scene under(LightShape shape, Point3 eye, double fov_y = 0.4)
{
    Scene scene;
    scene.lights = {light_of(std::move(shape))};
    scene.camera = {eye, {0, 0, 0}, {0, 1, 0}, fov_y};
    return scene;
}
double red(const Rendered& rendered, std::size_t pixel)
{
    return static_cast<double>(rendered.image.pixels[pixel][0]);
}

TEST(CloudPicture, ColoursThatChangeEvenlyDoSoInThePictureToo)
{
    Draws draws(41);
    constexpr std::size_t n = 4000;
    Mesh cloud = cloud_of(test::random_plane(n, draws));
    cloud.normals.assign(n, {0, 0, 1});
    for (const Point3 p : cloud.positions) {
        const auto c = static_cast<float>(0.5 + 0.4 * p.x);
        cloud.colors.push_back({c, c, c});
    }
    const double s = std::sqrt(4.0 / n);
    const Stage stage = staged(std::move(cloud));
    Scene scene = under(DirectionalLight{normalize({0, 0, -1})}, {0, 0, 5}, 0.3);
    scene.materials = {Lambert{Rgb::grey(1.0), true}};
    const Rendered rendered = picture(stage, scene, {60, 60, 1, {}, 0, 2});
    double squares = 0.0;
    for (int y = 0; y < 60; ++y) {
        for (int x = 0; x < 60; ++x) {
            const double at = (2.0 * (x + 0.5) / 60.0 - 1.0) * std::tan(0.15) * 5.0;
            const double d =
                red(rendered, rendered.image.at(x, y)) * std::numbers::pi - (0.5 + 0.4 * at);
            squares += d * d;
        }
    }
    // A single disc's colour would be off by the distance from its centre, rms R / sqrt(2) of its
    // uniform distribution (half of it along x). The mean of some seven is much nearer.
    const double single = 0.4 * 1.5 * s / 2.0;
    EXPECT_LT(std::sqrt(squares / 3600.0), 0.5 * single);
}

TEST(CloudPicture, NormalsTurnAsTheSurfaceDoes)
{
    Draws draws(42);
    constexpr std::size_t n = 3000;
    const Stage stage = staged(cloud_of(test::random_sphere(n, draws)));
    Scene scene = under(DirectionalLight{normalize({0, 0, -1})}, {0, 0, 6}, 0.2);
    RaytraceOptions options{60, 60, 1, {}, 0, 2};
    options.normal = true;
    const Rendered rendered = picture(stage, scene, options);
    double squares = 0.0;
    const PixelRays pixels(scene.camera, 60, 60);
    for (int y = 0; y < 60; ++y) {
        for (int x = 0; x < 60; ++x) {
            const Vec3 d = pixels.through(x + 0.5, y + 0.5);
            // |eye + t d| = 1
            const Vec3 eye = scene.camera.eye - Point3{};
            const double half = dot(eye, d);
            const double t = -half - std::sqrt(half * half - dot(eye, eye) + 1.0);
            const Rgbf normal = rendered.normal[rendered.image.at(x, y)];
            const Vec3 off = Vec3{static_cast<double>(normal[0]), static_cast<double>(normal[1]),
                                  static_cast<double>(normal[2])} -
                             (eye + d * t);
            squares += dot(off, off);
        }
    }
    // A single disc's normal would be off by the distance from its centre, rms R / sqrt(2).
    const double single = 1.5 * std::sqrt(4.0 * std::numbers::pi / n) / std::sqrt(2.0);
    EXPECT_LT(std::sqrt(squares / 3600.0), 0.5 * single);
}

TEST(CloudPicture, OfAClosedBodyHasNoDarkRim)
{
    Draws draws(43);
    for (const std::size_t n : {400U, 10000U}) {
        const Stage stage = staged(cloud_of(test::random_sphere(n, draws)));
        const Scene scene = under(EnvironmentLight{}, {0, 0, 6});
        const Rendered rendered = picture(stage, scene, {60, 60, 16, Rgb::grey(0.0), 0, 2});
        for (std::size_t i = 0; i < rendered.image.pixels.size(); ++i) {
            const auto coverage = static_cast<double>(rendered.image.coverage[i]);
            // Convex and white-skied: rho L wherever it is; an inner side would be black. Where
            // discs of a coarse cloud stand out, some of the sky is behind the others.
            ASSERT_GE(red(rendered, i), (n < 1000 ? 0.4 : 0.7) * coverage) << n << ": " << i;
            ASSERT_LE(red(rendered, i), 0.801 * coverage);
        }
    }
}

TEST(CloudPicture, OfASheetFromBehindIsItsOtherSide)
{
    Draws draws(44);
    Mesh cloud = cloud_of(test::random_plane(2000, draws));
    cloud.normals.assign(2000, {0, 0, 1});
    const Stage stage = staged(std::move(cloud));
    for (const double side : {1.0, -1.0}) {
        for (const double lit_side : {1.0, -1.0}) {
            const Scene scene =
                under(DirectionalLight{normalize({0, 0, -lit_side})}, {0.5, 0.2, 4.0 * side}, 0.3);
            const Rendered rendered = picture(stage, scene, {20, 20, 1, {}, 0, 2});
            const double expected = side == lit_side ? 0.8 / std::numbers::pi : 0.0;
            for (std::size_t i = 0; i < 400; ++i) {
                ASSERT_NEAR(red(rendered, i), expected, 1e-6) << side << lit_side;
            }
        }
    }
}

}  // namespace
}  // namespace relight
