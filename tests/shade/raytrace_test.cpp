// Pictures under every light: against closed forms and the oracle's values.
#include <gtest/gtest.h>

#include "core/light/dome.h"
#include "tests/oracle.h"
#include "tests/shade/corner.h"
#include "tests/statistics.h"

namespace relight {
namespace {

using nlohmann::json;
using test::band;
using test::Corner;
using test::light_of;
using test::Mean;
using test::mean_picture;
using test::NormalisedErrors;
using test::oracle;
using test::patchwork;
using test::picture;
using test::point_of;
using test::staged;
using test::vec_of;

constexpr double pi = std::numbers::pi;

TEST(RaytraceLight, TheErrorOfAPixelIsHonest)
{
    const Corner corner;
    constexpr int width = 10, height = 8, seeds = 100;
    const Rendered truth = picture(corner.stage, corner.scene, {width, height, 1600, {}, 999, 0});
    int within = 0, all = 0;
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        const Rendered one = picture(corner.stage, corner.scene, {width, height, 36, {}, seed, 0});
        for (std::size_t i = 0; i < one.image.pixels.size(); ++i) {
            for (std::size_t b = 0; b < 3; ++b) {
                const double off = band(one.image.pixels[i], b) - band(truth.image.pixels[i], b);
                within += std::abs(off) <= 1.96 * band(one.standard_error[i], b) + 1e-6 ? 1 : 0;
                ++all;
            }
        }
    }
    const double share = static_cast<double>(within) / all;
    EXPECT_GE(share, 0.92);
    EXPECT_LE(share, 0.98);
}

TEST(RaytraceLight, OneSampleAPixelTellsNoError)
{
    const Corner corner;
    EXPECT_TRUE(picture(corner.stage, corner.scene, {4, 3, 1, {}, 0, 0}).standard_error.empty());
    EXPECT_EQ(picture(corner.stage, corner.scene, {4, 3, 2, {}, 0, 0}).standard_error.size(), 12U);
}

TEST(RaytraceLight, IsTheSameToTheByteOnAnyNumberOfThreads)
{
    Corner corner;
    corner.scene.transport.bounces = 2;
    const auto on = [&](unsigned threads, std::uint64_t seed) {
        return picture(corner.stage, corner.scene, {60, 40, 4, {}, seed, threads, true, true});
    };
    const Rendered one = on(1, 7);
    for (const unsigned threads : {2U, 5U}) {
        const Rendered other = on(threads, 7);
        EXPECT_EQ(one.image.pixels, other.image.pixels);
        EXPECT_EQ(one.image.coverage, other.image.coverage);
        EXPECT_EQ(one.standard_error, other.standard_error);
        EXPECT_EQ(one.per_light, other.per_light);
        EXPECT_EQ(one.normal, other.normal);
        EXPECT_EQ(one.rays, other.rays);
    }
    EXPECT_NE(one.image.pixels, on(2, 8).image.pixels);
}

TEST(RaytraceLight, SoftShadowsAgreeWithTheExactPenumbra)
{
    const json file = oracle("occlusion");
    NormalisedErrors errors;
    constexpr double albedo = 0.5;
    int receivers = 0;
    for (const json& c : file["cases"]) {
        if (c["light"]["type"] != "rect") { continue; }
        Mesh blocker;
        for (const json& v : c["meshes"][0]["vertices"]) {
            blocker.positions.push_back(point_of(v));
        }
        blocker.faces.indices = {0, 1, 2, 0, 2, 3};
        const json& v = c["light"]["vertices"];
        Scene scene;
        scene.materials[0] = Lambert{Rgb::grey(albedo)};
        scene.lights = {light_of(test::rect_of(point_of(v[0]), point_of(v[1]), point_of(v[3])),
                                 Rgb::grey(c["light"]["L"].get<double>()))};
        for (const json& r : c["receivers"]) {
            const Point3 p = point_of(r["p"]);
            const Dir3 n = normalize(vec_of(r["n"]));
            const Stage stage = staged(test::joined(blocker, test::patch(p, n, 1e-3)));
            scene.camera = test::pinhead(p + Vec3(n) * 0.05, p, 1e-4);
            const Mean L = mean_picture(stage, scene, {2, 2, 400, {}, 5, 2});
            const double expected = albedo * r["E"].get<double>() / pi;
            errors.add(L.value.r - expected, L.error.r,
                       2e-5 * albedo * r["E_unoccluded"].get<double>() / pi,
                       c["id"].get<std::string>() + " receiver " + std::to_string(receivers));
            ++receivers;
        }
    }
    EXPECT_GE(receivers, 40);
    errors.expect_honest();
}

TEST(RaytraceLight, ASkyFurnaceHasNoNoiseAtAll)
{
    const Stage stage = staged(test::icosphere(2));
    Scene scene;
    scene.camera = frame(stage.surface->bounds, 0.7, 1.0);
    scene.materials[0] = Lambert{Rgb::grey(1.0)};
    scene.lights = {light_of(EnvironmentLight{}, {0.5, 1.0, 2.0})};
    scene.transport.shadows = false;
    const Rendered rendered = picture(stage, scene, {16, 16, 16, {}, 0, 2});
    // A direction below a facet but above its smooth normal brings nothing.
    for (std::size_t i = 0; i < rendered.image.pixels.size(); ++i) {
        EXPECT_LE(rendered.image.pixels[i][1], 1.0F + 1e-6F);
        EXPECT_GE(rendered.image.pixels[i][1], 0.9F);
        if (rendered.image.coverage[i] > 0.0F) { continue; }
        EXPECT_EQ(rendered.image.pixels[i], (Rgbf{0.5F, 1.0F, 2.0F}));
        EXPECT_EQ(rendered.standard_error[i], Rgbf{});
    }
    const Stage flat = staged(test::patch({}, normalize({0, 0, 1}), 1.0));
    scene.camera = {{0, 0, 1}, {0, 0, 0}, {0, 1, 0}, 0.5};
    for (const Rgbf& L : picture(flat, scene, {4, 4, 4, {}, 0, 2}).image.pixels) {
        EXPECT_NEAR(band(L, 2), 2.0, 1e-6);
    }
}

TEST(RaytraceLight, TheSkyIsTheBackgroundWhereNothingIsHit)
{
    const auto map = patchwork(32, 16);
    const EnvironmentLight sky{map, 0.7};
    const Rgb power{2.0, 1.0, 0.5};
    const Stage stage = staged(test::patch({0, 0, 50}, normalize({0, 0, 1}), 0.01));
    Scene scene;
    scene.lights = {light_of(sky, power)};
    scene.camera = {{}, {1, 0.2, -0.3}, {0, 1, 0}, 1.0};
    constexpr int width = 40, height = 30, fine = 40;
    const Rendered rendered = picture(stage, scene, {width, height, 256, {}, 0, 2});
    const PixelRays pixels(scene.camera, width, height);
    int whole = 0;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            Rgb sum;
            bool same = true;
            const auto along = [&](double dx, double dy) {
                return look(sky, pixels.through(x + dx, y + dy)).L * power;
            };
            const Rgb corner = along(0, 0);
            for (int i = 0; i < fine; ++i) {
                for (int j = 0; j < fine; ++j) {
                    const Rgb L = along((i + 0.5) / fine, (j + 0.5) / fine);
                    sum += L / (fine * fine);
                    same = same && L == corner;
                }
            }
            same = same && along(1, 0) == corner && along(0, 1) == corner && along(1, 1) == corner;
            const std::size_t at = rendered.image.at(x, y);
            const Rgbf& L = rendered.image.pixels[at];
            EXPECT_EQ(rendered.image.coverage[at], 0.0F);
            if (same) {
                ++whole;
                EXPECT_FLOAT_EQ(L[0], to_float(corner)[0]);
                EXPECT_EQ(rendered.standard_error[at], Rgbf{});
            } else {
                EXPECT_NEAR(band(L, 1), sum.g, 4.0 * band(rendered.standard_error[at], 1) + 0.02);
            }
        }
    }
    EXPECT_GT(whole, 300);
    for (const Rgbf& L : picture(stage, scene, {8, 6, 4, Rgb{3, 2, 1}, 0, 2}).image.pixels) {
        EXPECT_EQ(L, (Rgbf{3, 2, 1}));  // one that is given stands for the sky
    }
}

TEST(RaytraceLight, SamplesOfOnePixelBeyondWhatLanesHoldAllSeeTheSky)
{
    Image white;
    white.width = 16;
    white.height = 8;
    white.pixels.assign(128, Rgbf{1, 1, 1});
    Scene scene;
    scene.materials[0] = Lambert{Rgb::grey(0.5)};
    scene.lights = {light_of(EnvironmentLight{std::make_shared<const EnvironmentMap>(white), 0.0})};
    const Stage stage = staged(test::patch({}, normalize({0, 0, 1}), 1.0));
    constexpr int samples = 2500;
    ASSERT_GT(samples, 2 * DomeLanes::most);
    scene.camera = test::pinhead({0, 0, 1}, {0, 0, 2});
    EXPECT_EQ(picture(stage, scene, {1, 1, samples, {}, 0, 1}).image.pixels[0], (Rgbf{1, 1, 1}));
    scene.camera = test::pinhead({0, 0, 1}, {});
    const Mean L = mean_picture(stage, scene, {1, 1, samples, {}, 0, 1});
    EXPECT_LT(L.error.g, 0.01);
    EXPECT_NEAR(L.value.g, 0.5, 5.0 * L.error.g);
}

TEST(RaytraceLight, AFlatPlaceUnderAMapShowsTheIntegralOfItsHemisphere)
{
    const auto map = patchwork(7, 5);
    const Dir3 n = normalize({0.4, 0.8, -0.3});
    Rgb E;  // midpoints of equal areas
    constexpr int rows = 500, columns = 1000;
    for (int i = 0; i < rows; ++i) {
        const double y = 1.0 - (2.0 * i + 1.0) / rows, r = std::sqrt(1.0 - y * y);
        for (int j = 0; j < columns; ++j) {
            const double phi = 2.0 * pi * (j + 0.5) / columns;
            const Vec3 w{r * std::cos(phi), y, r * std::sin(phi)};
            E += map->radiance(w) * (std::max(0.0, dot(n, w)) * 4.0 * pi / (rows * columns));
        }
    }
    Scene scene;
    scene.materials[0] = Lambert{Rgb::grey(0.5)};
    scene.lights = {light_of(EnvironmentLight{map, 0.0})};
    scene.camera = test::pinhead(Point3{} + Vec3(n), {});
    const Stage stage = staged(test::patch({}, n, 1.0));
    const Mean L = mean_picture(stage, scene, {8, 8, 256, {}, 3, 1});
    const Rgb expected = E * (0.5 / pi);
    EXPECT_LT(L.error.b, 0.004 * expected.b);
    EXPECT_NEAR(L.value.r, expected.r, 5.0 * L.error.r + 1e-3 * expected.r);
    EXPECT_NEAR(L.value.b, expected.b, 5.0 * L.error.b + 1e-3 * expected.b);
}

TEST(RaytraceLight, ASunsDiscStandsInTheSky)
{
    const Stage stage = staged(test::patch({0, 0, 50}, normalize({0, 0, 1}), 0.01));
    Scene scene;
    const double radius = 0.05;
    scene.lights = {light_of(DirectionalLight{normalize({-1, 0, 0}), radius}, Rgb::grey(3.0))};
    scene.camera = {{}, {1, 0, 0}, {0, 1, 0}, 0.2};
    const Rendered rendered = picture(stage, scene, {21, 21, 64, {}, 0, 2});
    const double L = 3.0 / (pi * std::sin(radius) * std::sin(radius));
    EXPECT_NEAR(band(rendered.image.pixels[rendered.image.at(10, 10)], 0), L, 1e-5 * L);
    EXPECT_EQ(rendered.image.pixels[0], Rgbf{});
    double E = 0.0;  // of a surface that faces the sun: sum of L cos over the pixels
    for (int y = 0; y < 21; ++y) {
        for (int x = 0; x < 21; ++x) {
            E += band(rendered.image.pixels[rendered.image.at(x, y)], 0) *
                 pixel_solid_angle(0.2, 21, 21, x, y);
        }
    }
    EXPECT_NEAR(E, 3.0, 0.03);
}

TEST(RaytraceLight, ShadowsCanBeSwitchedOffAndCutShort)
{
    Mesh mesh = test::patch({}, normalize({0, 0, 1}), 0.5);
    mesh = test::joined(mesh, test::patch({0, 0, 1}, normalize({0, 0, 1}), 3.0));
    const Stage stage = staged(mesh);
    Scene scene;
    scene.materials[0] = Lambert{Rgb::grey(0.5)};
    const RectLight rect = test::rect_of({-1, -1, 2}, {-1, 1, 2}, {1, -1, 2});
    scene.camera = test::pinhead({0, 0.2, 0.5}, {});
    const double sheltered = 0.0;
    for (const LightShape& shape : {LightShape(rect), LightShape(PointLight{{0, 0, 2}, {}}),
                                    LightShape(EnvironmentLight{})}) {
        scene.lights = {light_of(shape)};
        scene.transport = {};
        const auto L = [&] { return mean_picture(stage, scene, {2, 2, 400, {}, 0, 1}); };
        const auto closed = closed_irradiance(shape, {}, normalize({0, 0, 1}));
        const double open = 0.5 * closed.value_or(0.25) / pi;
        EXPECT_LE(L().value.r, sheltered + 0.2 * open);
        scene.transport.max_distance = 0.9;
        EXPECT_NEAR(L().value.r, open, 4.0 * L().error.r + 1e-5);
        scene.transport.max_distance.reset();
        scene.lights[0].cast_shadows = false;
        EXPECT_NEAR(L().value.r, open, 4.0 * L().error.r + 1e-5);
        scene.lights[0].cast_shadows = true;
        scene.transport.shadows = false;
        EXPECT_NEAR(L().value.r, open, 4.0 * L().error.r + 1e-5);
    }
}

TEST(RaytraceLight, DistancesAreInTheFilesUnitOfLength)
{
    const Stage stage = staged(test::patch({}, normalize({0, 0, 1}), 1.0));
    Scene scene;
    scene.lights = {light_of(PointLight{{0, 0, 2}, {}}, Rgb::grey(3))};
    scene.camera = test::pinhead({0, 1, 1}, {});
    for (const double unit : {1.0, 0.001, 25.4}) {
        scene.length_unit_m = unit;
        const double L = 0.8 / pi * 3.0 / (4.0 * unit * unit);
        EXPECT_NEAR(mean_picture(stage, scene, {2, 2, 4, {}, 0, 1}).value.r, L, 1e-5 * L);
    }
}

TEST(RaytraceLight, LightBelowTheFaceBringsNothingWhateverItsNormals)
{
    Mesh mesh = test::patch({}, normalize({0, 0, 1}), 1.0);
    mesh.normals.assign(4, normalize({1, 0, 0.3}));  // leaning toward a sun below the face
    const Stage stage = staged(mesh);
    Scene scene;
    scene.transport.terminator = Terminator::None;
    scene.transport.shadows = false;
    scene.camera = test::pinhead({1, 0, 2}, {0.2, 0.1, 0});
    const auto lit_from = [&](Vec3 toward_sun) {
        scene.lights = {light_of(DirectionalLight{normalize(-toward_sun)})};
        return mean_picture(stage, scene, {1, 1, 4, {}, 0, 1}).value.r;
    };
    EXPECT_EQ(lit_from({1, 0, -0.1}), 0.0);
    EXPECT_GT(lit_from({1, 0, 0.1}), 0.1);
}

TEST(RaytraceLight, BrushedMetalFollowsTheTextureCoordinates)
{
    const Dir3 n = normalize({0, 0, 1});
    Mesh mesh = test::patch({}, n, 1.0);
    const auto with_uvs = [&](bool turned) {
        mesh.uvs.clear();
        for (const Point3 p : mesh.positions) {
            const auto x = static_cast<float>(p.x), y = static_cast<float>(p.y);
            mesh.uvs.push_back(turned ? std::array{y, -x} : std::array{x, y});
        }
        return staged(mesh);
    };
    CookTorrance brushed;
    brushed.alpha_x = 0.1;
    brushed.alpha_y = 0.5;
    CookTorrance across = brushed;
    std::swap(across.alpha_x, across.alpha_y);
    Scene scene;
    scene.lights = {light_of(PointLight{{1, 0.3, 1.5}, {}}, Rgb::grey(5))};
    scene.camera = {{-1, 0.5, 1.4}, {}, {0, 0, 1}, 0.6};
    const auto shown = [&](const Stage& stage, const CookTorrance& material) {
        scene.materials[0] = make_cook_torrance(material);
        return picture(stage, scene, {9, 9, 4, {}, 0, 1}).image.pixels;
    };
    const Stage along_x = with_uvs(false), along_y = with_uvs(true);
    const auto a = shown(along_x, brushed), b = shown(along_y, across), c = shown(along_y, brushed);
    double differs = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_NEAR(band(a[i], 0), band(b[i], 0), 1e-5 * band(a[i], 0) + 1e-9);
        differs = std::max(differs, std::abs(band(a[i], 0) - band(c[i], 0)) / band(a[i], 0));
    }
    EXPECT_GT(differs, 0.2);
}

TEST(RaytraceLight, TheNormalIsThatOfTheSideSeen)
{
    const Stage stage = staged(test::patch({}, normalize({0.3, 0, 1}), 1.0));
    Scene scene;
    for (const double side : {1.0, -1.0}) {
        scene.camera = {{0, 0, 3.0 * side}, {}, {0, 1, 0}, 1.0};
        const Rendered r = picture(stage, scene, {9, 9, 4, {}, 0, 1, false, true});
        const Dir3 n = normalize(Vec3{0.3, 0, 1} * side);
        int partly = 0;
        for (std::size_t i = 0; i < r.normal.size(); ++i) {
            const float covered = r.image.coverage[i];
            partly += covered > 0.0F && covered < 1.0F ? 1 : 0;
            const double hit = covered > 0.0F ? 1.0 : 0.0;
            EXPECT_NEAR(band(r.normal[i], 0), hit * n.x(), 1e-6);
            EXPECT_NEAR(band(r.normal[i], 2), hit * n.z(), 1e-6);
        }
        EXPECT_GT(partly, 4);
    }
}

TEST(RaytraceLight, IsFiniteAndNotNegativeWhateverTheScene)
{
    Mesh mesh = test::joined(test::grid(4), test::icosphere(1));
    mesh = test::joined(mesh, test::grid(4));  // coincident faces
    mesh = test::joined(mesh, test::mesh_of({{0, 0, 2}, {1, 0, 2}, {2, 0, 2}}, {0, 1, 2}));
    const Stage stage = staged(mesh);
    CookTorrance sharp;
    sharp.alpha_x = sharp.alpha_y = 0.0;
    MetallicRoughness coated;
    coated.clearcoat = 1.0;
    coated.roughness = 0.0;
    const std::vector<Material> materials{Lambert{}, make_cook_torrance(sharp), coated,
                                          Principled{}};
    Scene scene;
    scene.lights = {light_of(RectLight{{0, 0, 1.5}, {}, {}}),              // no area
                    light_of(RectLight{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}),  // in the floor
                    light_of(SphereLight{{0, 0, 0}, 1.0}),                 // of the ball's size
                    light_of(SphereLight{{0, 0, 0}, 0.0}),
                    light_of(DiskLight{{0, 0, -1}, normalize({0, 0, 1}), 2.0}),
                    light_of(PointLight{{0, 0, 1}, {}}),  // on the ball
                    light_of(EnvironmentLight{patchwork(4, 2), 1.0}),
                    light_of(DirectionalLight{normalize({1, 0, 0}), 1.5})};
    scene.transport.bounces = 2;
    for (const Material& material : materials) {
        scene.materials[0] = material;
        for (const Camera& camera :
             {Camera{{0, -3, 1e-9}, {0, 0, 0}, {0, 0, 1}, 0.8},  // grazing
              Camera{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}, 2.0},      // inside
              Camera{{1, 1, 1}, {1, 1, 1}, {0, 0, 1}, 0.8}}) {   // no direction
            scene.camera = camera;
            const Rendered r = picture(stage, scene, {24, 24, 4, {}, 0, 2, true, true});
            for (std::size_t i = 0; i < r.image.pixels.size(); ++i) {
                for (std::size_t b = 0; b < 3; ++b) {
                    EXPECT_TRUE(is_finite(band(r.image.pixels[i], b)));
                    EXPECT_GE(r.image.pixels[i][b], 0.0F);
                    EXPECT_TRUE(is_finite(band(r.standard_error[i], b)));
                    EXPECT_GE(r.standard_error[i][b], 0.0F);
                    EXPECT_TRUE(is_finite(band(r.normal[i], b)));
                }
            }
        }
    }
}

}  // namespace
}  // namespace relight
