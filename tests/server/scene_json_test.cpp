#include "server/scene_json.h"

#include <gtest/gtest.h>

#include <numbers>

namespace relight {
namespace {

RelightRequest parsed(const std::string& json)
{
    auto request = parse_request(json, {});
    EXPECT_TRUE(request) << request.error().pointer << ": " << request.error().detail;
    return request ? std::move(*request) : RelightRequest{};
}
std::string with(const std::string& fields)
{
    return R"({"mesh":{"positions":[[0,0,0],[1,0,0],[0,1,0]]},)" + fields + "}";
}

TEST(SceneJson, ReadsInlineArraysAsTheyAre)
{
    const auto request = parsed(R"({"mesh":{"positions":[[0.1,2,-3e2],[4,5,6],[7,8,9]],
        "faces":[[2,1,0]],"normals":[[0,0,2],[0,1,0],[1,0,0]],"colors":[[0,0.5,1],[1,1,1],[0,0,0]]}})");
    const Mesh& mesh = std::get<InlineMesh>(request.mesh)->mesh;
    EXPECT_EQ(mesh.positions[0], (Point3{0.1, 2, -300}));
    EXPECT_EQ(mesh.faces.indices, (std::vector<std::uint32_t>{2, 1, 0}));
    EXPECT_EQ(mesh.normals[0], (Vec3{0, 0, 2}));
    EXPECT_EQ(mesh.colors[0], (Rgbf{0, 0.5F, 1}));
    EXPECT_EQ(mesh.format, "json");
}

TEST(SceneJson, KnowsTheFormsOfAMesh)
{
    const std::string id(64, 'a');
    EXPECT_EQ(std::get<StoredMesh>(parsed(R"({"mesh":{"id":")" + id + "\"}}").mesh).id, id);
    EXPECT_EQ(std::get<PartMesh>(parsed(R"({"mesh":{"part":"p"}})").mesh).part, "p");
    const auto by_part = parse_request("{}", {}, true);
    ASSERT_TRUE(by_part);
    EXPECT_EQ(std::get<PartMesh>(by_part->mesh).part, "mesh");
}

TEST(SceneJson,
     TurnsFluxIntoIntensity)  // I = Phi / 4 pi; spot: Phi / 2 pi [(1 - ci) + (ci - co)/3]
{
    const auto request = parsed(with(R"("lights":[
        {"type":"point","position":[0,0,1],"flux_w":40,"color":[1,0.5,0]},
        {"type":"spot","position":[0,0,1],"direction":[0,0,-2],"flux_w":40,
         "inner_cone_deg":20,"outer_cone_deg":35}])"));
    const auto& lights = request.scene.lights;
    EXPECT_NEAR(lights[0].power.r, 40 / (4 * std::numbers::pi), 1e-12);
    EXPECT_NEAR(lights[0].power.g, 20 / (4 * std::numbers::pi), 1e-12);
    EXPECT_EQ(lights[0].power.b, 0);
    const double ci = std::cos(20 * std::numbers::pi / 180);
    const double co = std::cos(35 * std::numbers::pi / 180);
    EXPECT_NEAR(lights[1].power.r, 40 / (2 * std::numbers::pi * ((1 - ci) + (ci - co) / 3)), 1e-9);
    EXPECT_EQ(std::get<SpotLight>(lights[1].shape).axis.z(), -1);
}

TEST(SceneJson, IsPhotometricWhenItsLightsAre)
{
    EXPECT_EQ(parsed(with(R"("lights":[{"type":"point","position":[0,0,1],"intensity_cd":1}])"))
                  .scene.units,
              Units::Photometric);
    EXPECT_EQ(
        parsed(with(R"("lights":[{"type":"point","position":[0,0,1],"flux_w":1}])")).scene.units,
        Units::Radiometric);
    EXPECT_EQ(parsed(with(R"("lights":[])")).scene.units, Units::Radiometric);
}

TEST(SceneJson, ConvertsWattsByTheEfficacyItIsGiven)
{
    const auto request = parsed(with(R"("luminous_efficacy_lm_w":100,"lights":[
        {"type":"point","position":[0,0,1],"intensity_w_sr":2},
        {"type":"directional","direction":[0,0,-1],"illuminance_lx":7}])"));
    EXPECT_EQ(request.scene.units, Units::Photometric);
    EXPECT_EQ(request.scene.lights[0].power.r, 200);
    EXPECT_EQ(request.scene.lights[1].power.r, 7);
}

TEST(SceneJson, NamesLightsByTheirPlace)
{
    const auto request = parsed(with(R"("lights":[
        {"type":"point","position":[0,0,1],"flux_w":1},
        {"type":"point","position":[0,0,1],"flux_w":1,"name":"key"},
        {"type":"point","position":[0,0,1],"flux_w":1,"enabled":false,"cast_shadows":false}])"));
    EXPECT_EQ(request.scene.lights[0].name, "light_0");
    EXPECT_EQ(request.scene.lights[1].name, "key");
    EXPECT_EQ(request.scene.lights[2].name, "light_2");
    EXPECT_FALSE(request.scene.lights[2].enabled);
    EXPECT_FALSE(request.scene.lights[2].cast_shadows);
}

TEST(SceneJson, ReadsMaterials)
{
    EXPECT_EQ(std::get<Lambert>(parsed(with(R"("lights":[])")).scene.materials[0]).albedo,
              Rgb::grey(0.8));
    const auto vertex = parsed(with(R"("material":{"model":"lambert","albedo":"vertex"})"));
    EXPECT_TRUE(std::get<Lambert>(vertex.scene.materials[0]).albedo_from_vertex);
    const auto metal = parsed(with(R"("material":{"model":"cook_torrance","albedo":[0,0,0],
        "eta":[0.2,0.9,1.4],"k":[3.9,2.5,1.9],"roughness":0.5,"distribution":"beckmann"})"));
    const auto& facets = std::get<CookTorrance>(metal.scene.materials[0]);
    EXPECT_EQ(facets.distribution, Distribution::Beckmann);
    EXPECT_EQ(facets.alpha_x, 0.25);  // roughness squared
    EXPECT_EQ(std::get<ConductorEtaK>(facets.fresnel).k, (Rgb{3.9, 2.5, 1.9}));
}

TEST(SceneJson, ReadsTheRest)
{
    const auto request = parsed(with(R"("length_unit_m":0.001,
        "view":{"type":"direction","toward_viewer":[0,3,0]},
        "camera":{"eye":[0,0,5],"fov_y_deg":90},
        "transport":{"shadows":false,"two_sided":true,"terminator":"none","max_distance":2,
                     "samples":64,"seed":0,"bounces":0,"target_standard_error":null},
        "points":{"radius_scale":2,"normals":"estimate","viewpoint":[1,2,3]},
        "refine":{"max_edge":0.5},
        "display":{"exposure_ev":"auto","tone_map":"reinhard_extended","white":3,"transfer":"srgb"},
        "output":{"format":"png","width":10,"height":20,"samples":4,"renderer":"vtk",
                  "background":"transparent"})"));
    EXPECT_EQ(request.scene.length_unit_m, 0.001);
    EXPECT_EQ(std::get<DirectionView>(request.scene.view).toward_viewer.y(), 1);
    EXPECT_FALSE(request.scene.transport.shadows);
    EXPECT_TRUE(request.scene.transport.two_sided);
    EXPECT_EQ(request.scene.transport.terminator, Terminator::None);
    EXPECT_EQ(request.scene.transport.max_distance, 2);
    EXPECT_EQ(request.points.radius_scale, 2);
    EXPECT_EQ(request.points.estimate, true);
    EXPECT_EQ(request.points.viewpoint, (Point3{1, 2, 3}));
    EXPECT_EQ(request.max_edge, 0.5);
    EXPECT_TRUE(request.display.auto_exposure);
    EXPECT_EQ(request.display.tone_map, ToneMap::ReinhardExtended);
    EXPECT_EQ(request.display.white, 3);
    EXPECT_EQ(request.output.format, Format::Png);
    EXPECT_EQ(request.output.width, 10);
    EXPECT_EQ(request.output.renderer, Renderer::Vtk);
    EXPECT_TRUE(request.output.transparent);
}

TEST(SceneJson, DrawsMoreSamplesWhenItHasATarget)
{
    const auto transport = [](const std::string& fields) {
        return parsed(with(R"("transport":{)" + fields + "}")).scene.transport;
    };
    EXPECT_EQ(transport("").samples, 64U);
    EXPECT_FALSE(transport("").target_standard_error);
    EXPECT_EQ(transport(R"("samples":7,"target_standard_error":null)").samples, 7U);
    EXPECT_EQ(transport(R"("target_standard_error":0.5)").samples, 4096U);
    EXPECT_EQ(transport(R"("target_standard_error":0.5)").target_standard_error, 0.5);
    EXPECT_EQ(transport(R"("target_standard_error":0.5,"samples":65536)").samples, 65536U);
    EXPECT_EQ(transport(R"("bounces":64)").bounces, 64U);
}

TEST(SceneJson, ReadsEachQuantityAsItself)
{
    const std::pair<std::string, bool Quantities::*> all[] = {
        {"color", &Quantities::color},
        {"irradiance", &Quantities::irradiance},
        {"radiance", &Quantities::radiance},
        {"ambient_occlusion", &Quantities::ambient_occlusion},
        {"visibility", &Quantities::visibility},
        {"normal", &Quantities::normal},
        {"standard_error", &Quantities::standard_error},
        {"per_light", &Quantities::per_light},
        {"sh", &Quantities::sh}};
    for (const auto& [name, asked] : all) {
        const Output output = parsed(with(R"("output":{"quantities":[")" + name + R"("]})")).output;
        EXPECT_TRUE(output.names_quantities);
        for (const auto& [other, member] : all) {
            EXPECT_EQ(output.quantities.*member, member == asked) << name << ' ' << other;
        }
    }
    for (const char* silent : {R"("output":{"format":"exr"})", R"("lights":[])"}) {
        const Output output = parsed(with(silent)).output;
        EXPECT_TRUE(output.quantities.color);
        EXPECT_FALSE(output.names_quantities);
    }
}

TEST(SceneJson, TellsATransparentBackgroundFromNone)
{
    const auto output = [](const std::string& fields) {
        return parsed(with(R"("output":{"format":"exr")" + fields + "}")).output;
    };
    EXPECT_EQ(output("").format, Format::Exr);
    EXPECT_FALSE(output("").background);
    EXPECT_FALSE(output("").transparent);
    EXPECT_TRUE(output(R"(,"background":"transparent")").transparent);
    EXPECT_FALSE(output(R"(,"background":"transparent")").background);
    EXPECT_EQ(output(R"(,"background":[0,1,2])").background, (Rgb{0, 1, 2}));
    EXPECT_FALSE(output(R"(,"background":[0,1,2])").transparent);
}

}  // namespace
}  // namespace relight
