#include "core/shade/shade.h"

#include <gtest/gtest.h>

#include "core/shade/raytrace.h"
#include "tests/oracle.h"
#include "tests/scenes.h"

namespace relight {
namespace {

using test::light_of;
using test::staged;

struct Lit {
    Stage stage;
    Transport transport;
    Shaded shaded;
};

Lit lit(Mesh mesh, const Scene& scene, unsigned threads = 2)
{
    Progress progress;
    Lit result;
    result.stage = staged(std::move(mesh));
    result.transport = trace(result.stage, scene, {true, false, false, threads}, progress);
    result.shaded =
        shade(result.stage, result.transport, scene, {true, true, true, threads}, progress);
    return result;
}

Scene sun_and_lamp()
{
    Scene scene;
    scene.lights = {light_of(DirectionalLight{normalize({0.1, 0.3, -1})}, {3, 2, 1}),
                    light_of(PointLight{{0.4, 0.1, 1.5}, {}}, {5, 5, 9})};
    scene.materials[0] = Lambert{{0.8, 0.5, 0.2}};
    return scene;
}

TEST(Shade, LambertRadianceIsAlbedoTimesIrradianceOverPi)
{
    const Lit a = lit(test::icosphere(3), sun_and_lamp());
    const Rgb albedo{0.8, 0.5, 0.2};
    for (std::size_t v = 0; v < a.shaded.irradiance.size(); ++v) {
        const Rgb E = to_double(a.shaded.irradiance[v]);
        const Rgb expected = albedo * E / std::numbers::pi;
        EXPECT_NEAR(static_cast<double>(a.shaded.radiance[v][1]), expected.g, 1e-6 * expected.g);
    }
}

TEST(Shade, ATwoSidedSheetShowsTheLightOfBothSidesAlongItsNormal)
{
    Scene scene = sun_and_lamp();                                        // both above
    scene.lights[0].shape = DirectionalLight{normalize({0.1, 0.3, 1})};  // and now one below
    scene.transport.two_sided = true;
    const Lit a = lit(test::grid(3), scene);
    for (std::size_t v = 0; v < a.shaded.irradiance.size(); ++v) {
        const double expected =
            0.8 * static_cast<double>(a.shaded.irradiance[v][0]) / std::numbers::pi;
        EXPECT_NEAR(static_cast<double>(a.shaded.radiance[v][0]), expected, 1e-6 * expected);
        EXPECT_GT(a.shaded.per_light[0][v][0], 0.0F);
    }
    scene.view = DirectionView{normalize({0, 0, 1})};  // from above only the lamp's side is seen
    const Lit above = lit(test::grid(3), scene);
    EXPECT_LT(above.shaded.radiance[5][0], a.shaded.radiance[5][0]);
    EXPECT_GT(above.shaded.radiance[5][0], 0.0F);
}

TEST(Shade, LightsSuperposeAndPowerIsLinear)
{
    Scene both = sun_and_lamp();
    const Lit whole = lit(test::icosphere(3), both);
    both.lights[0].power = both.lights[0].power * 2.0;
    both.lights[1].enabled = false;
    const Lit doubled = lit(test::icosphere(3), both);
    for (std::size_t v = 0; v < whole.shaded.irradiance.size(); ++v) {
        for (std::size_t c = 0; c < 3; ++c) {
            const float sum = whole.shaded.per_light[0][v][c] + whole.shaded.per_light[1][v][c];
            EXPECT_FLOAT_EQ(sum, whole.shaded.irradiance[v][c]);
            EXPECT_EQ(doubled.shaded.irradiance[v][c], 2.0F * whole.shaded.per_light[0][v][c]);
        }
    }
}

TEST(Shade, TheColoursOfAVertexAreItsAlbedoWhenAskedFor)
{
    Mesh mesh = test::grid(1);
    mesh.colors = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5F, 0.5F, 0.5F}};
    Scene scene = sun_and_lamp();
    Lambert material;
    material.albedo_from_vertex = true;
    scene.materials[0] = material;
    const Lit a = lit(mesh, scene);
    EXPECT_GT(a.shaded.radiance[0][0], 0.0F);
    EXPECT_EQ(a.shaded.radiance[0][1], 0.0F);
    EXPECT_EQ(a.shaded.radiance[1][0], 0.0F);
    EXPECT_GT(a.shaded.radiance[3][2], 0.0F);
}

TEST(Shade, AViewerBelowTheHorizonSeesNothing)
{
    Scene scene = sun_and_lamp();
    scene.view = CameraView{};
    scene.camera.eye = {0, 0, -3};
    const Lit below = lit(test::grid(4), scene);
    for (const Rgbf& L : below.shaded.radiance) { EXPECT_EQ(L, (Rgbf{0, 0, 0})); }
    scene.view = DirectionView{normalize({0, 1, 2})};
    const Lit above = lit(test::grid(4), scene);
    EXPECT_GT(above.shaded.radiance[0][0], 0.0F);
}

TEST(Shade, AGlossyHighlightStandsWhereTheMirrorSaysItDoes)
{
    const int n = 40;
    Scene scene;
    scene.lights = {light_of(PointLight{{-0.5, 0, 1}, {}}, Rgb::grey(10))};
    scene.view = CameraView{};
    scene.camera.eye = {0.5, 0, 1};
    scene.materials[0] = Lambert{};
    const auto brightest = [&](const Scene& s) {
        const Lit a = lit(test::grid(n), s);
        std::size_t best = 0;
        for (std::size_t v = 0; v < a.shaded.radiance.size(); ++v) {
            if (a.shaded.radiance[v][0] > a.shaded.radiance[best][0]) { best = v; }
        }
        return a.stage.mesh->positions[best];
    };
    EXPECT_LT(brightest(scene).x, -0.4);  // diffuse: below the lamp
    CookTorrance mirror;
    mirror.alpha_x = mirror.alpha_y = 0.05;
    scene.materials[0] = mirror;
    EXPECT_NEAR(brightest(scene).x, 0.0, 0.06);  // glossy: half-way to the viewer
}

TEST(Shade, IsTheSameToTheBitOnAnyNumberOfThreads)
{
    const Lit one = lit(test::icosphere(4), sun_and_lamp(), 1);
    const Lit eight = lit(test::icosphere(4), sun_and_lamp(), 8);
    EXPECT_EQ(one.shaded.irradiance, eight.shaded.irradiance);
    EXPECT_EQ(one.shaded.radiance, eight.shaded.radiance);
}

TEST(VertexScenes, LambertRadianceOfTheWholeIsItsPartsTimesAlbedo)  // the oracle's Lo, its own E
{
    const auto file = test::oracle("vertex_scenes");
    for (const auto& c : file["cases"]) {
        const Rgb albedo = test::rgb_of(c["albedo"]);
        for (const auto& v : c["vertices"]) {
            const Rgb E = Rgb::grey(v["E_total"].get<double>());
            const BsdfValue fr = f(Material(Lambert{albedo}), {0, 0, 1}, {0, 0, 1}, {});
            const Radiance L = fr * Irradiance{E};
            EXPECT_NEAR(L.value.r, v["Lo_lambert"][0].get<double>(), 1e-5 * L.value.r + 1e-6);
        }
    }
}

Rendered render(const Stage& stage, const Scene& scene, RaytraceOptions options)
{
    Progress progress;
    return raytrace(stage, scene, options, progress);
}

TEST(Raytrace, TheRadianceOfAWallDoesNotDependOnTheCamerasDistance)
{
    const Stage stage = staged(test::moved(test::grid(3), test::upright(), 50.0, {}));
    Scene scene;
    scene.lights = {light_of(DirectionalLight{normalize({0.3, 0, -1})}, Rgb::grey(2))};
    for (const double distance : {1.0, 5.0, 25.0}) {
        scene.camera = {{0, 0, distance}, {0, 0, 0}, {0, 1, 0}, 0.6};
        const Image image = render(stage, scene, {16, 12, 4, {}, 0, 1}).image;
        const double expected = 0.8 * 2.0 * normalize({-0.3, 0, 1}).z() / std::numbers::pi;
        for (const Rgbf& L : image.pixels) {
            EXPECT_NEAR(static_cast<double>(L[0]), expected, 1e-6);
        }
    }
}

TEST(Raytrace,
     PixelsAgreeWithVerticesWhereASurfaceIsFlat)  // two independent ways to the same number
{
    Scene scene = sun_and_lamp();
    const Mesh floor = test::joined(
        test::grid(8), test::moved(test::icosphere(2), test::upright(), 0.2, {0.2, 0.1, 0.5}));
    const Lit vertices = lit(floor, scene);
    scene.camera = {{0, -3, 4}, {0, 0, 0}, {0, 0, 1}, 0.6};
    // A narrow camera on one vertex after the other: its one pixel is a cone around the vertex.
    int compared = 0;
    for (const std::size_t v : {10U, 20U, 22U, 31U, 40U, 41U, 50U, 59U, 70U}) {
        const Point3 p = floor.positions[v];
        Scene close = scene;
        close.camera = {p + Vec3{0, -0.03, 0.04}, p, {0, 0, 1}, 1e-5};
        const Image image = render(vertices.stage, close, {1, 1, 4, {}, 0, 1}).image;
        const double L = static_cast<double>(vertices.shaded.radiance[v][1]);
        EXPECT_NEAR(static_cast<double>(image.pixels[0][1]), L, 1e-4 * std::max(L, 0.1)) << v;
        ++compared;
    }
    EXPECT_GE(compared, 8);
}

TEST(Raytrace, IsTheSameToTheBitOnAnyNumberOfThreadsAndDiffersBySeed)
{
    const Stage stage = staged(test::icosphere(2));
    Scene scene = sun_and_lamp();
    scene.camera = frame(stage.surface->bounds, 0.7, 1.0);
    const Rendered one = render(stage, scene, {40, 40, 9, {}, 5, 1});
    const Rendered eight = render(stage, scene, {40, 40, 9, {}, 5, 8});
    EXPECT_EQ(one.image.pixels, eight.image.pixels);
    EXPECT_EQ(one.rays, eight.rays);
    EXPECT_NE(one.image.pixels, render(stage, scene, {40, 40, 9, {}, 6, 1}).image.pixels);
}

TEST(Raytrace, TheFramedModelTouchesNoBorderAndFillsThePicture)
{
    for (const Vec3 shift : {Vec3{}, Vec3{1e7, -1e7, 0}}) {
        const Stage stage = staged(test::moved(test::icosphere(3), test::upright(), 5.0, shift));
        Scene scene;
        scene.camera = frame(stage.surface->bounds, 0.7, 1.5);
        const Image image = render(stage, scene, {60, 40, 4, {}, 0, 2}).image;
        double covered = 0.0;
        for (int y = 0; y < 40; ++y) {
            for (int x = 0; x < 60; ++x) {
                const float c = image.coverage[image.at(x, y)];
                covered += static_cast<double>(c) / (60 * 40);
                if (x == 0 || y == 0 || x == 59 || y == 39) { EXPECT_EQ(c, 0.0F); }
            }
        }
        EXPECT_GT(covered, 0.15);
    }
}

TEST(Raytrace, TheBackgroundShowsOnlyWhereNothingIs)
{
    const Stage stage = staged(test::grid(2));
    Scene scene;
    scene.camera = {{1, 0, 3}, {1, 0, 0}, {0, 1, 0}, 0.3};  // the grid ends in the middle
    const Image image = render(stage, scene, {9, 5, 16, Rgb{0.2, 0.4, 0.6}, 0, 1}).image;
    EXPECT_EQ(image.pixels[image.at(8, 2)], to_float({0.2, 0.4, 0.6}));
    EXPECT_EQ(image.pixels[image.at(0, 2)], (Rgbf{0, 0, 0}));  // no light: black, and opaque
    EXPECT_NEAR(static_cast<double>(image.pixels[image.at(4, 2)][1]), 0.2, 0.04);
}

TEST(Raytrace, ShowsTheSideThatTheCameraSees)
{
    Scene scene;
    scene.lights = {light_of(DirectionalLight{normalize({0, 0, 1})}, Rgb::grey(2))};
    scene.camera = {{0, 0, -3}, {0, 0, 0}, {0, 1, 0}, 0.3};
    const Stage sheet = staged(test::grid(2));  // its front looks away
    const Image lit_back = render(sheet, scene, {3, 3, 4, {}, 0, 1}).image;
    EXPECT_NEAR(static_cast<double>(lit_back.pixels[4][0]), 0.8 * 2.0 / std::numbers::pi, 1e-6);
    scene.camera.eye = {0, 0, 3};  // the light is behind it
    EXPECT_EQ(render(sheet, scene, {3, 3, 4, {}, 0, 1}).image.pixels[4], (Rgbf{0, 0, 0}));
}

TEST(Raytrace, FiledNormalsSayWhichSideIsTheFront)
{
    Mesh sheet = test::grid(2);
    sheet.normals.assign(sheet.positions.size(), {0, 0, -1});  // against the winding
    Scene scene;
    scene.lights = {light_of(DirectionalLight{normalize({0, 0, 1})}, Rgb::grey(2))};
    scene.camera = {{0, 0, -3}, {0, 0, 0}, {0, 1, 0}, 0.3};
    const Image image = render(staged(sheet), scene, {3, 3, 4, {}, 0, 1}).image;
    EXPECT_NEAR(static_cast<double>(image.pixels[4][0]), 0.8 * 2.0 / std::numbers::pi, 1e-6);
}

TEST(Raytrace, TheTerminatorOptionFreesARoundMeshOfItsFacetsShadows)
{
    const Stage stage = staged(test::icosphere(1));  // coarse, smooth normals
    Scene scene;
    scene.lights = {light_of(DirectionalLight{normalize({1, 0, -0.4})}, Rgb::grey(3))};
    scene.camera = {{0, 0, 6}, {0, 0, 0}, {0, 1, 0}, 0.4};
    Scene unshadowed = scene;
    unshadowed.transport.shadows = false;
    const auto darkened = [&](Terminator terminator) {  // pixels that a shadow ray took light from
        scene.transport.terminator = terminator;
        const Image with = render(stage, scene, {80, 80, 1, {}, 0, 2}).image;
        const Image without = render(stage, unshadowed, {80, 80, 1, {}, 0, 2}).image;
        int count = 0;
        for (std::size_t i = 0; i < with.pixels.size(); ++i) {
            count += with.pixels[i][0] < without.pixels[i][0] ? 1 : 0;
        }
        return count;
    };
    EXPECT_GT(darkened(Terminator::None), 40);
    EXPECT_LT(darkened(Terminator::Smooth), darkened(Terminator::None) / 10);
}

TEST(Raytrace, ACloudLooksLikeASurface)
{
    Mesh cloud = test::icosphere(4);
    cloud.faces = {};
    for (const Point3 p : cloud.positions) { cloud.normals.push_back(p - Point3{}); }
    const Stage stage = staged(cloud);
    Scene scene;
    scene.lights = {light_of(DirectionalLight{normalize({0, 0, -1})}, Rgb::grey(3))};
    scene.camera = {{0, 0, 6}, {0, 0, 0}, {0, 1, 0}, 0.4};
    const Image image = render(stage, scene, {60, 60, 4, {}, 0, 2}).image;
    const double middle = static_cast<double>(image.pixels[image.at(30, 30)][0]);
    EXPECT_NEAR(middle, 0.8 * 3.0 / std::numbers::pi, 0.01);
    int holes = 0;
    for (int y = 0; y < 60; ++y) {
        for (int x = 0; x < 60; ++x) {
            const double r = std::hypot(x - 29.5, y - 29.5);
            holes += r < 20 && image.coverage[image.at(x, y)] < 1.0F ? 1 : 0;
        }
    }
    EXPECT_EQ(holes, 0);
}

}  // namespace
}  // namespace relight
