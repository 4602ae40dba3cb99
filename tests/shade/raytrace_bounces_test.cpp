// Pictures of light that comes by way of other surfaces, mirrors and shining faces: against closed
// forms, the oracle's values and the columns.
#include <gtest/gtest.h>

#include "core/transport/column.h"
#include "tests/oracle.h"
#include "tests/shade/corner.h"
#include "tests/statistics.h"

namespace relight {
namespace {

using nlohmann::json;
using test::band;
using test::Corner;
using test::glowing;
using test::light_of;
using test::Mean;
using test::mean_of;
using test::mean_picture;
using test::mirror;
using test::NormalisedErrors;
using test::oracle;
using test::patchwork;
using test::picture;
using test::rgb_of;
using test::staged;

constexpr double pi = std::numbers::pi;

TEST(RaytraceBounces, TheImagesOfTheLightsAddUpToThePicture)
{
    Corner corner;
    Scene& scene = corner.scene;
    scene.materials[0] = glowing({0.5, 0.6, 0.7}, {0.3, 0.2, 0.1});
    scene.lights.push_back(test::light_of_faces(corner.stage, scene.materials[0]));
    scene.lights[3].enabled = false;
    scene.transport.bounces = 1;
    const auto sum_at = [](const Rendered& r, std::size_t i, std::size_t b) {
        double sum = 0.0;
        for (const auto& one : r.per_light) { sum += band(one[i], b); }
        return sum;
    };
    const RaytraceOptions options{24, 16, 16, {}, 0, 0, true, true};
    const Rendered sky = picture(corner.stage, scene, options);
    RaytraceOptions grey = options;
    grey.background = Rgb::grey(0.25);
    const Rendered given = picture(corner.stage, scene, grey);
    ASSERT_EQ(sky.per_light.size(), scene.lights.size());
    for (const Rgbf& L : sky.per_light[3]) { EXPECT_EQ(L, Rgbf{}); }
    int fronts = 0, nothing = 0;
    for (std::size_t i = 0; i < sky.image.pixels.size(); ++i) {
        const double covered = static_cast<double>(sky.image.coverage[i]);
        nothing += covered == 0.0 ? 1 : 0;
        for (std::size_t b = 0; b < 3; ++b) {
            const double rest = band(sky.image.pixels[i], b) - sum_at(sky, i, b);
            const double Le = 0.1 * static_cast<double>(3 - b);
            if (covered == 0.0) { EXPECT_NEAR(rest, 0.0, 1e-6); }
            if (covered == 1.0) { EXPECT_NEAR(rest, Le, 1e-6); }
            const double with_grey = band(given.image.pixels[i], b) - sum_at(given, i, b);
            EXPECT_NEAR(with_grey, rest + 0.25 * (1.0 - covered), 1e-6);
        }
        fronts += covered == 1.0 ? 1 : 0;
    }
    EXPECT_GT(fronts, 50);
    EXPECT_GT(nothing, 10);
}

TEST(RaytraceBounces, ALightsImageIsThePictureUnderItAlone)
{
    Corner corner;
    corner.scene.transport.bounces = 1;
    const RaytraceOptions options{24, 16, 16, {}, 0, 0, true};
    const Rendered all = picture(corner.stage, corner.scene, options);
    for (std::size_t l = 0; l < corner.scene.lights.size(); ++l) {
        Scene alone = corner.scene;
        for (std::size_t k = 0; k < alone.lights.size(); ++k) { alone.lights[k].enabled = k == l; }
        alone.lights[l].power = alone.lights[l].power * 2.0;
        const Rendered one = picture(corner.stage, alone, options);
        for (std::size_t i = 0; i < one.image.pixels.size(); ++i) {
            for (std::size_t b = 0; b < 3; ++b) {
                const double L = band(one.image.pixels[i], b);
                EXPECT_NEAR(2.0 * band(all.per_light[l][i], b), L, 1e-5 * L) << l;
            }
        }
    }
}

TEST(RaytraceBounces, AGlowingRoomIsAFurnace)
{
    const json file = oracle("interreflection");
    NormalisedErrors errors;
    int cases = 0;
    std::uint64_t seed = 0;
    for (const json& c : file["cases"]) {
        if (c["kind"] != "furnace_enclosure") { continue; }
        ++cases;
        const Rgb albedo = rgb_of(c["in"]["albedo"]), Le = rgb_of(c["in"]["Le"]);
        const Stage stage = staged(test::room({-1, -0.7, -0.5}, {0.8, 0.9, 0.6}));
        Scene scene;
        scene.materials[0] = glowing(albedo, Le);
        scene.camera = {{-0.3, -0.2, -0.1}, {0.5, 0.4, 0.3}, {0, 0, 1}, 1.2};
        scene.lights = {test::light_of_faces(stage, scene.materials[0])};
        const json& series = c["out"]["E_after_n_bounces"];
        for (unsigned picked = 0; picked < 3 * series.size(); ++picked) {  // three pictures each
            const unsigned n = picked / 3;
            scene.transport.bounces = n;
            const Rendered rendered = picture(stage, scene, {3, 2, 256, {}, seed++, 2});
            const Rgb expected = Le + albedo * rgb_of(series[n]) / pi;
            const Mean L = mean_of(rendered, 256);
            const std::string place = c["id"].get<std::string>() + " bounces " + std::to_string(n);
            errors.add(L.value.r - expected.r, L.error.r, 1e-5 * expected.r, place);
            EXPECT_NEAR(L.value.g, expected.g, 4.0 * L.error.g + 1e-5 * expected.g) << place;
            EXPECT_NEAR(L.value.b, expected.b, 4.0 * L.error.b + 1e-5 * expected.b) << place;
            for (std::size_t i = 0; i < rendered.image.pixels.size(); ++i) {
                EXPECT_NEAR(band(rendered.image.pixels[i], 1), expected.g,
                            6.0 * band(rendered.standard_error[i], 1) + 1e-5 * expected.g)
                    << place << " pixel " << i;
            }
        }
    }
    EXPECT_GE(cases, 4);
    errors.expect_honest();
}

TEST(RaytraceBounces, AMirrorShowsTheSkyThatItReflects)
{
    const auto map = patchwork(8, 4);
    Scene scene;
    scene.lights = {light_of(EnvironmentLight{map, 0.0})};
    scene.materials[0] = mirror();
    const Dir3 n = normalize({0.1, 1.0, 0.2});
    const Stage stage = staged(test::patch({}, n, 1.0));
    int seen = 0;
    for (const Vec3 from :
         {Vec3{1, 1, 0.3}, Vec3{-1, 1.5, 0.4}, Vec3{0.3, 1.2, 1}, Vec3{0.2, 1, -1.1}}) {
        const Dir3 wo = normalize(from);
        const Vec3 reflected = Vec3(n) * (2.0 * dot(n, wo)) - wo;
        scene.camera = test::pinhead(Point3{} + Vec3(wo), {});
        const Mean L = mean_picture(stage, scene, {4, 4, 256, {}, 0, 2});
        const Rgb texel = map->radiance(reflected);
        EXPECT_NEAR(L.value.r, texel.r, 0.02 * texel.r);
        EXPECT_NEAR(L.value.g, texel.g, 0.02 * texel.g);
        EXPECT_NEAR(L.value.b, texel.b, 0.02 * texel.b);
        ++seen;
    }
    EXPECT_EQ(seen, 4);
}

TEST(RaytraceBounces, AreaLightsAreSeenBeforeASurfaceAndInItsMirror)
{
    const Stage stage = staged(test::patch({}, normalize({0, 0, 1}), 20.0));
    const DiskLight disk{{1, 0, 1}, normalize({-1, 0, -1}), 0.3};
    Scene scene;
    scene.materials[0] = mirror();
    scene.lights = {light_of(disk, Rgb::grey(4.0))};
    const auto at = [&](Point3 eye, Point3 target) {
        scene.camera = test::pinhead(eye, target);
        return mean_picture(stage, scene, {4, 4, 64, {}, 0, 1});
    };
    EXPECT_NEAR(at({-1, 0, 1}, {1, 0, 1}).value.r, 4.0, 1e-5);  // straight, nothing behind it
    EXPECT_EQ(at({3, 0, 1}, {1, 0, 1}).value.r, 0.0);           // from behind it
    const Mean reflected = at({-1, 0, 1}, {0, 0, 0});
    EXPECT_NEAR(reflected.value.r, 4.0, 0.02 + 4.0 * reflected.error.r);
    EXPECT_LT(at({-1, 0, 1}, {0.6, 0, 0}).value.r, 0.01);
    scene.materials[0] = Lambert{Rgb{}};
    EXPECT_NEAR(at({-2, 0, 3}, {1, 0, 1}).value.r, 4.0, 1e-5);  // before a black floor
    EXPECT_EQ(at({-2, 0, -4}, {1, 0, 1}).value.r, 0.0);         // the floor hides it
}

TEST(RaytraceBounces, GlossyLightGoesOnAsOftenAsBouncesSay)
{
    // The eye looks into one mirror, that into another, and that at a lit wall.
    Mesh mesh = test::patch({0, 0, 0}, normalize({0, 0, 1}), 0.5);
    mesh = test::joined(mesh, test::patch({2, 0, 2}, normalize({-1, 0, 0}), 0.5));
    mesh = test::joined(mesh, test::patch({0.0, 0, 4}, normalize({0, 0, -1}), 0.5));
    mesh.materials = {"mirror", "wall"};
    mesh.face_materials = {0, 0, 0, 0, 1, 1};
    const Stage stage = staged(mesh);
    Scene scene;
    scene.materials = {mirror(), Lambert{Rgb::grey(0.5)}};
    scene.material_of_group = {0, 1};
    scene.lights = {light_of(DirectionalLight{normalize({0, 0, 1})}, Rgb::grey(2.0))};
    scene.lights[0].cast_shadows = false;
    scene.camera = test::pinhead({-2, 0, 2}, {});
    const double wall = 0.5 * 2.0 / pi;
    for (const unsigned bounces : {0U, 1U, 2U, 3U}) {
        scene.transport.bounces = bounces;
        const Mean L = mean_picture(stage, scene, {2, 2, 1024, {}, 0, 1});
        EXPECT_NEAR(L.value.r, bounces < 2 ? 0.0 : wall, 4.0 * L.error.r) << bounces;
        EXPECT_LE(L.error.r, 0.01 * wall);
    }
}

TEST(RaytraceBounces, PixelsAgreeWithVerticesUnderEveryLightAndWithBounces)
{
    // The columns' way to the same number: other samplers, other random numbers.
    Mesh mesh = test::grid(2);  // its middle vertex is looked at
    mesh = test::joined(mesh, test::patch({0.6, 0.3, 0.8}, normalize({-0.4, -0.2, -1}), 0.4));
    mesh = test::joined(mesh, test::patch({-0.9, 0, 0.5}, normalize({1, 0, 0}), 0.5));
    mesh.materials = {"floor", "glowing"};
    mesh.face_materials.assign(12, 0);
    mesh.face_materials[8] = mesh.face_materials[9] = 1;
    const Stage stage = staged(mesh);
    Scene scene;
    scene.materials = {Lambert{{0.8, 0.5, 0.3}}, glowing({0.4, 0.5, 0.6}, {3, 2, 1})};
    scene.material_of_group = {0, 1};
    const auto [a, b, c] = stage.surface->triangles[8];
    const auto [d, e, g] = stage.surface->triangles[9];
    const auto& p = stage.mesh->positions;
    const Rgb Le{3, 2, 1};
    const LightShape faces = MeshLight{std::make_shared<const EmitterTable>(
        std::vector<Emitter>{{{p[a], p[b], p[c]}, 8, Le}, {{p[d], p[e], p[g]}, 9, Le}})};
    const std::vector<LightShape> shapes{
        PointLight{{0.2, 0.5, 1.0}, {}},
        DirectionalLight{normalize({-0.5, 0.2, -1}), 0.1},
        test::rect_of({-0.3, -0.8, 0.9}, {-0.3, -0.4, 0.9}, {0.2, -0.8, 0.9}),
        DiskLight{{-0.4, 0.6, 0.7}, normalize({0.3, -0.4, -1}), 0.3},
        SphereLight{{0.3, -0.6, 0.6}, 0.2},
        EnvironmentLight{patchwork(16, 8), 0.3},
        EnvironmentLight{},
        faces};
    constexpr std::size_t vertex = 4;
    NormalisedErrors errors;
    for (std::size_t s = 0; s < shapes.size(); ++s) {
        for (const unsigned bounces : {0U, 1U, 3U}) {
            scene.lights = {light_of(shapes[s], {1.0, 2.0, 3.0})};
            scene.transport.bounces = bounces;
            scene.transport.samples = 4096;
            scene.camera = test::pinhead(p[vertex] + Vec3{-0.1, -0.2, 0.3}, p[vertex]);
            const Column column = relight::column(stage, scene, 0, vertex, vertex + 1);
            const auto number = [&](const std::vector<float>& values, std::size_t bands) {
                return values.empty() ? 0.0 : static_cast<double>(values[bands == 1 ? 0 : 1]);
            };
            const double scale = 0.5 * 2.0 / pi;  // green
            const double E = number(column.E, column.bands) + number(column.E_bounced, 3);
            const double other = number(column.standard_error, bounces > 0 ? 3 : column.bands);
            for (std::uint64_t seed = 0; seed < 3; ++seed) {
                const Mean L = mean_picture(stage, scene, {3, 3, 256, Rgb{}, seed, 2});
                errors.add(L.value.g - scale * E, std::hypot(L.error.g, scale * other),
                           1e-5 * scale * E,
                           "light " + std::to_string(s) + " bounces " + std::to_string(bounces));
            }
        }
    }
    errors.expect_honest();
}

TEST(RaytraceBounces, FacesShineOnlyOnTheirFrontsAndLightOthersOnlyAsALight)
{
    Mesh mesh = test::patch({}, normalize({0, 0, 1}), 0.5);
    mesh = test::joined(mesh, test::patch({0, 0, 1}, normalize({0, 0, -1}), 0.5));
    const Stage stage = staged(mesh);
    Scene scene;
    scene.materials[0] = glowing(Rgb::grey(0.5), Rgb::grey(2.0));
    const auto at = [&](Point3 eye, Point3 target) {
        scene.camera = test::pinhead(eye, target);
        return mean_picture(stage, scene, {2, 2, 64, {}, 0, 1});
    };
    EXPECT_NEAR(at({0.1, 0, 0.5}, {}).value.r, 2.0, 1e-6);
    EXPECT_EQ(at({0.1, 0, -0.5}, {}).value.r, 0.0);
    scene.transport.bounces = 2;
    EXPECT_NEAR(at({0.1, 0, 0.5}, {}).value.r, 2.0, 1e-6);  // no light: nothing to be reflected
    scene.transport.bounces = 0;
    scene.lights = {test::light_of_faces(stage, scene.materials[0])};
    const RectLight above = test::rect_of({-0.5, -0.5, 1}, {-0.5, 0.5, 1}, {0.5, -0.5, 1});
    const double E = 2.0 * irradiance(above, {}, normalize({0, 0, 1}));
    const Mean lit = at({0.1, 0, 0.5}, {});
    EXPECT_NEAR(lit.value.r, 2.0 + 0.5 * E / pi, 4.0 * lit.error.r);
    EXPECT_GT(E, 1.0);
}

TEST(RaytraceBounces, AFaceLightsThroughWhatCastsNoShadow)
{
    Mesh mesh = test::patch({}, normalize({0, 0, 1}), 0.5);
    mesh = test::joined(mesh, test::patch({0, 0, 1}, normalize({0, 0, -1}), 0.5));
    mesh = test::joined(mesh, test::patch({0, 0, 0.6}, normalize({0, 0, 1}), 2.0));
    mesh.materials = {"dark", "glowing"};
    mesh.face_materials = {0, 0, 1, 1, 0, 0};
    const Stage stage = staged(mesh);
    Scene scene;
    scene.materials = {Lambert{Rgb::grey(0.5)}, glowing(Rgb{}, Rgb::grey(2.0))};
    scene.material_of_group = {0, 1};
    std::vector<Emitter> emitters;
    for (const std::uint32_t t : {2U, 3U}) {
        const auto [a, b, c] = stage.surface->triangles[t];
        const auto& p = stage.mesh->positions;
        emitters.push_back({{p[a], p[b], p[c]}, t, Rgb::grey(2.0)});
    }
    scene.lights = {light_of(MeshLight{std::make_shared<const EmitterTable>(emitters)})};
    scene.camera = test::pinhead({0.1, 0, 0.4}, {});
    const RectLight above = test::rect_of({-0.5, -0.5, 1}, {-0.5, 0.5, 1}, {0.5, -0.5, 1});
    const double open = 0.5 * 2.0 * irradiance(above, {}, normalize({0, 0, 1})) / pi;
    const auto L = [&] { return mean_picture(stage, scene, {4, 4, 256, {}, 0, 1}); };
    EXPECT_EQ(L().value.r, 0.0);
    scene.transport.max_distance = 0.5;
    EXPECT_NEAR(L().value.r, open, 4.0 * L().error.r);
    scene.transport.max_distance.reset();
    scene.lights[0].cast_shadows = false;
    EXPECT_NEAR(L().value.r, open, 4.0 * L().error.r);
    EXPECT_LT(L().error.r, 0.01 * open);
}

}  // namespace
}  // namespace relight
