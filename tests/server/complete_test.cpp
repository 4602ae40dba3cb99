// What of a request depends on its mesh: camera, materials of groups, the mesh's own light.
#include <gtest/gtest.h>

#include <numbers>

#include "core/base/progress.h"
#include "server/fields.h"
#include "server/scene_json.h"
#include "tests/shapes.h"

namespace relight {
namespace {

RelightRequest parsed(const std::string& fields)
{
    auto request = parse_request(R"({"mesh":{"part":"m"}, )" + fields + "}", {});
    EXPECT_TRUE(request) << request.error().pointer << ": " << request.error().detail;
    return request ? std::move(*request) : RelightRequest{};
}

/// Three triangles in the plane z = 0, of areas 1/2, 2 and 9/2, each its own group.
Mesh three_groups()
{
    Mesh mesh =
        test::mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}, {0, 2, 0}, {3, 0, 0}, {0, 3, 0}},
                      {0, 1, 2, 0, 3, 4, 0, 5, 6});
    mesh.materials = {"floor", "lamp", "0"};
    mesh.face_materials = {0, 1, 2};
    return mesh;
}
Result<Scene> completed(const std::string& fields, const Mesh& mesh)
{
    Progress progress;
    return complete(parsed(fields), {mesh, {}, {}}, mesh, prepare(mesh, 1, progress));
}
std::string groups(const std::string& fields)
{
    return R"("lights":[],"materials":{)" + fields + "}";
}
const std::string glowing =
    R"({"model":"metallic_roughness","emissive":[1,0.5,0],"emissive_strength":100})";

TEST(Complete, TheDefaultSunShinesOverTheViewersShoulder)
{
    const auto scene = completed(R"("view":{"type":"normal"})", test::icosphere(0));
    ASSERT_TRUE(scene);
    ASSERT_EQ(scene->lights.size(), 1U);
    EXPECT_EQ(scene->lights[0].name, "light_0");
    EXPECT_EQ(scene->units, Units::Radiometric);
    const Dir3 travel = std::get<DirectionalLight>(scene->lights[0].shape).travel;
    EXPECT_GT(dot(travel, normalize(scene->camera.target - scene->camera.eye)), 0.5);
    EXPECT_LT(dot(travel, axes(scene->camera).up), 0.0);
}

TEST(Complete, NoLightIsNotTheDefaultLight)
{
    const auto scene = completed(R"("lights":[])", test::icosphere(0));
    ASSERT_TRUE(scene);
    EXPECT_TRUE(scene->lights.empty());
}

TEST(Complete, ACameraOnItsTargetSeesNothing)
{
    const auto scene =
        completed(R"("camera":{"eye":[1,2,3],"target":[1,2,3]})", test::icosphere(0));
    ASSERT_FALSE(scene);
    EXPECT_EQ(scene.error().fault, Fault::ZeroDirection);
    EXPECT_EQ(scene.error().pointer, "/camera/eye");
}

TEST(Complete, GivesEachGroupItsMaterialAndTheRestTheFirst)
{
    const auto scene = completed(
        R"("material":{"model":"oren_nayar"},)" + groups(R"("lamp":{"model":"principled"})"),
        three_groups());
    ASSERT_TRUE(scene);
    ASSERT_EQ(scene->materials.size(), 2U);
    EXPECT_TRUE(std::holds_alternative<OrenNayar>(scene->materials[0]));
    EXPECT_TRUE(std::holds_alternative<Principled>(scene->materials[1]));
    EXPECT_EQ(scene->material_of_group, (std::vector<std::uint32_t>{0, 1, 0}));
    EXPECT_TRUE(completed(R"("lights":[])", three_groups())->material_of_group.empty());
}

TEST(Complete, AGroupIsItsNameBeforeItIsAnIndex)
{
    const auto scene = completed(
        groups(
            R"("1":{"model":"lambert"},"0":{"model":"oren_nayar"},"floor":{"model":"principled"})"),
        three_groups());
    ASSERT_TRUE(scene);
    // "1" is nobody's name: the lamp. "0" is the name of the last.
    EXPECT_EQ(scene->material_of_group, (std::vector<std::uint32_t>{3, 1, 2}));
}

TEST(Complete, ReadiesMicrofacetsThatNeedATable)
{
    const std::string gtr =
        R"({"model":"cook_torrance","distribution":"gtr","gamma":1.5,"roughness":0.5})";
    const auto scene =
        completed(R"("material":)" + gtr + "," + groups(R"("lamp":)" + gtr), three_groups());
    ASSERT_TRUE(scene);
    for (const Material& material : scene->materials) {
        EXPECT_TRUE(std::get<CookTorrance>(material).gtr_masking);
    }
}

TEST(Complete, MakesTheSkies)
{
    const auto scene = completed(
        R"("lights":[{"type":"point","position":[0,0,1],"intensity_cd":1},
                     {"type":"sky","sun_direction":[0,2,2],"turbidity":3,"name":"clear"}])",
        three_groups());
    ASSERT_TRUE(scene);
    EXPECT_EQ(scene->lights[1].name, "clear");
    const auto& sky = std::get<SkyLight>(scene->lights[1].shape);
    ASSERT_TRUE(sky.dome);
    EXPECT_LT(length(Vec3(sky.sun.travel) + Vec3(normalize({0, 2, 2}))), 1e-12);
    EXPECT_GT(sky.sun_E_perp.g, 0);
}

TEST(Complete, TheMeshsOwnLightIsItsShiningTriangles)  // Phi = pi L A of their front
{
    const auto scene = completed(R"("lights":[{"type":"from_mesh","color":[2,2,2]}],
                                    "materials":{"lamp":)" +
                                     glowing + "}",
                                 three_groups());
    ASSERT_TRUE(scene) << scene.error().detail;
    const auto& table = *std::get<MeshLight>(scene->lights[0].shape).table;
    EXPECT_EQ(table.size(), 1U);
    EXPECT_NEAR(table.flux().r, std::numbers::pi * 100 * 2, 1e-9);
    EXPECT_NEAR(table.flux().g, std::numbers::pi * 50 * 2, 1e-9);
    EXPECT_EQ(table.radiance(1), (Rgb{100, 50, 0}));  // the second triangle; unit power
    EXPECT_EQ(table.radiance(0), Rgb{});
    EXPECT_EQ(scene->lights[0].power, Rgb::grey(2));
    EXPECT_EQ(scene->units, Units::Photometric);
}

TEST(Complete, FindsTheFaceOfEachTriangleOfAPolygon)
{
    Mesh mesh = test::mesh_of(
        {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {5, 0, 0}, {6, 0, 0}, {6, 1, 0}, {5, 1, 0}},
        {0, 1, 2, 3, 4, 5, 6, 7});
    mesh.faces.offsets = {0, 4, 8};
    mesh.materials = {"dark", "lamp"};
    mesh.face_materials = {0, 1};
    const auto scene =
        completed(R"("lights":[{"type":"from_mesh"}],"materials":{"lamp":)" + glowing + "}", mesh);
    ASSERT_TRUE(scene);
    const auto& table = *std::get<MeshLight>(scene->lights[0].shape).table;
    EXPECT_EQ(table.size(), 2U);
    EXPECT_NEAR(table.flux().r, std::numbers::pi * 100, 1e-9);
    EXPECT_EQ(table.radiance(2).r, 100);
    EXPECT_EQ(table.radiance(3).r, 100);
}

TEST(Complete, AMeshThatShinesIsItsOwnDefaultLight)
{
    const auto scene = completed(R"("material":)" + glowing, three_groups());
    ASSERT_TRUE(scene);
    ASSERT_EQ(scene->lights.size(), 1U);
    EXPECT_EQ(scene->lights[0].name, "light_0");
    EXPECT_EQ(std::get<MeshLight>(scene->lights[0].shape).table->size(), 3U);
    EXPECT_EQ(scene->lights[0].power, Rgb::grey(1));
    EXPECT_EQ(scene->units, Units::Photometric);
}

/// A request that its mesh cannot serve.
struct Refusal {
    std::string fields;
    Fault fault;
    std::string pointer, says;
};

void expect_refusals(const Mesh& mesh, std::initializer_list<Refusal> rows)
{
    for (const Refusal& row : rows) {
        const auto scene = completed(row.fields, mesh);
        ASSERT_FALSE(scene) << row.fields;
        EXPECT_EQ(fault_code(scene.error().fault), fault_code(row.fault)) << row.fields;
        EXPECT_EQ(scene.error().pointer, row.pointer) << row.fields;
        EXPECT_NE(scene.error().detail.find(row.says), std::string::npos) << row.fields << '\n'
                                                                          << scene.error().detail;
    }
}

TEST(Complete, RefusesGroupsThatTheMeshDoesNotHave)
{
    expect_refusals(
        three_groups(),
        {{groups(R"("lmap":{"model":"lambert"})"), Fault::UnknownValue, "/materials/lmap",
          R"("floor", "lamp", "0", or their indices 0..2)"},
         {groups(R"("a/b":{"model":"lambert"})"), Fault::UnknownValue, "/materials/a~1b", "a/b"},
         {groups(R"("3":{"model":"lambert"})"), Fault::UnknownValue, "/materials/3", "0..2"},
         {groups(R"("-1":{"model":"lambert"})"), Fault::UnknownValue, "/materials/-1", "0..2"},
         {groups(R"("1.0":{"model":"lambert"})"), Fault::UnknownValue, "/materials/1.0", "0..2"},
         {groups(R"("99999999999999999999":{"model":"lambert"})"), Fault::UnknownValue,
          "/materials/99999999999999999999", "0..2"},
         {groups(R"("":{"model":"lambert"})"), Fault::UnknownValue, "/materials/", "0..2"},
         {groups(R"("lamp":{"model":"lambert"},"1":{"model":"lambert"})"), Fault::ConflictingFields,
          "/materials/1", "\"lamp\" is the same group"},
         {groups(R"("01":{"model":"lambert"},"lamp":{"model":"lambert"})"),
          Fault::ConflictingFields, "/materials/lamp", "\"01\" is the same group"}});
    expect_refusals(test::icosphere(0),
                    {{groups(R"("0":{"model":"lambert"})"), Fault::UnknownValue, "/materials/0",
                      "names no materials; \"material\" is for the whole"}});
}

TEST(Complete, RefusesVertexColoursThatTheMeshDoesNotHave)
{
    const auto vertex = [](const std::string& model, const std::string& field) {
        return R"({"model":")" + model + R"(",")" + field + R"(":"vertex"})";
    };
    for (const auto& [model, field] : {std::pair{"lambert", "albedo"},
                                       {"oren_nayar", "albedo"},
                                       {"cook_torrance", "albedo"},
                                       {"principled", "base_color"},
                                       {"metallic_roughness", "base_color"}}) {
        const std::string whole = R"("material":)" + vertex(model, field);
        const std::string one = groups(R"("lamp":)" + vertex(model, field));
        expect_refusals(
            three_groups(),
            {{whole, Fault::ConflictingFields, std::string("/material/") + field,
              "neither colours nor a texture"},
             {one, Fault::ConflictingFields, std::string("/materials/lamp/") + field, "[r,g,b]"}});
        Mesh coloured = three_groups();
        coloured.colors.resize(coloured.positions.size());
        EXPECT_TRUE(completed(whole, coloured)) << model;
        EXPECT_TRUE(completed(one, coloured)) << model;
    }
}

/// Three groups as a file brings them with materials and lights of its own.
Asset with_looks()
{
    Asset asset{three_groups(), {}, {}};
    asset.mesh.maps.resize(3);
    asset.materials.resize(3);
    for (std::size_t i = 0; i < 3; ++i) {
        asset.materials[i].roughness = 0.1 * (1.0 + static_cast<double>(i));
    }
    asset.lights = {{"lamp", PointLight{{0, 0, 3}, {}}, Rgb::grey(100.0)},
                    {"sun", DirectionalLight{normalize(Vec3{0, 0, -1})}, Rgb::grey(5.0)}};
    return asset;
}
Result<Scene> completed(const std::string& fields, const Asset& asset)
{
    Progress progress;
    return complete(parsed(fields), asset, asset.mesh, prepare(asset.mesh, 1, progress));
}

TEST(Complete, AFilesOwnMaterialsStandWhereTheRequestHasNone)
{
    const auto roughness = [](const Scene& scene, std::size_t group) {
        const Material& material = scene.materials[scene.material_of_group[group]];
        const auto* own = std::get_if<MetallicRoughness>(&material);
        return own == nullptr ? -1.0 : own->roughness;
    };
    const auto textured = [](const Scene& scene, std::size_t group) {
        return scene.textured[scene.material_of_group[group]];
    };
    const auto all = completed(R"("view":{"type":"normal"})", with_looks());
    ASSERT_TRUE(all);
    for (std::size_t group = 0; group < 3; ++group) {
        EXPECT_DOUBLE_EQ(roughness(*all, group), 0.1 * (1.0 + static_cast<double>(group)));
        EXPECT_TRUE(textured(*all, group));
    }
    const auto but_one = completed(groups(R"("lamp":{"model":"lambert"})"), with_looks());
    ASSERT_TRUE(but_one);
    EXPECT_EQ(roughness(*but_one, 0), 0.1);
    EXPECT_EQ(roughness(*but_one, 1), -1.0);
    EXPECT_FALSE(textured(*but_one, 1));
    EXPECT_DOUBLE_EQ(roughness(*but_one, 2), 0.3);
    const auto none =
        completed(R"("material":{"model":"lambert","albedo":[0.5,0.5,0.5]})", with_looks());
    ASSERT_TRUE(none);
    EXPECT_EQ(none->materials.size(), 1U);
    EXPECT_TRUE(none->material_of_group.empty());
    EXPECT_TRUE(none->textured.empty());
}

TEST(Complete, ACloudHasTheFilesFirstMaterial)
{
    Asset cloud = with_looks();
    cloud.mesh.faces = {};
    cloud.mesh.face_materials = {};
    const auto scene = completed(R"("view":{"type":"normal"})", cloud);
    ASSERT_TRUE(scene);
    EXPECT_EQ(std::get<MetallicRoughness>(scene->materials.front()).roughness, 0.1);
    EXPECT_TRUE(scene->textured.front());
}

TEST(Complete, AFilesOwnLightsShineWhereTheRequestHasNoneOrAsksForThem)
{
    const auto by_default = completed(R"("view":{"type":"normal"})", with_looks());
    ASSERT_TRUE(by_default);
    EXPECT_EQ(by_default->units, Units::Photometric);
    ASSERT_EQ(by_default->lights.size(), 2U);
    EXPECT_EQ(by_default->lights[0].name, "lamp");
    EXPECT_EQ(by_default->lights[1].power, Rgb::grey(5.0));

    const auto beside = completed(
        R"("lights":[{"type":"from_mesh","color":[2,2,2],"cast_shadows":false},
                     {"type":"point","name":"sun","position":[0,0,1],"intensity_cd":1}],
           "materials":{"1":)" +
            glowing + "}",
        with_looks());
    ASSERT_TRUE(beside) << beside.error().detail;
    std::vector<std::string> names;
    for (const Light& light : beside->lights) { names.push_back(light.name); }
    EXPECT_EQ(names, (std::vector<std::string>{"lamp", "sun_", "light_0", "sun"}));
    EXPECT_EQ(beside->lights[0].power, Rgb::grey(200.0));
    EXPECT_FALSE(beside->lights[1].cast_shadows);
    EXPECT_EQ(std::get<MeshLight>(beside->lights[2].shape).table->size(), 1U);
}

TEST(Complete, RefusesAFilesLightsBesideWatts)
{
    const std::string beside = R"("lights":[{"type":"point","position":[0,0,1],"flux_w":1},
                                            {"type":"from_mesh"}])";
    const auto scene = completed(beside, with_looks());
    ASSERT_FALSE(scene);
    EXPECT_EQ(scene.error().fault, Fault::MixedUnits);
    EXPECT_EQ(scene.error().pointer, "/lights/1");
    EXPECT_TRUE(completed(R"("luminous_efficacy_lm_w":100,)" + beside, with_looks()));
}

TEST(Complete, RefusesTheLightOfAMeshThatIsDark)
{
    const std::string beside =
        R"("lights":[{"type":"point","position":[0,0,1],"flux_w":1},{"type":"from_mesh"}])";
    expect_refusals(three_groups(),
                    {{beside, Fault::MissingField, "/lights/1", "emissive_strength"},
                     {beside + R"(,"material":{"model":"metallic_roughness"})", Fault::MissingField,
                      "/lights/1", "\"emissive\": [r,g,b]"},
                     {beside + R"(,"material":{"model":"metallic_roughness","emissive":[1,1,1],
                                               "emissive_strength":0})",
                      Fault::MissingField, "/lights/1", "no face of it shines"}});
    Mesh flat = test::mesh_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {0, 1, 2});  // no area
    flat.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
    expect_refusals(flat, {{beside + R"(,"material":)" + glowing, Fault::MissingField, "/lights/1",
                            "no face of it shines"}});
    flat.faces = {};
    expect_refusals(flat, {{beside + R"(,"material":)" + glowing, Fault::MissingField, "/lights/1",
                            "no face of it shines"}});
}

}  // namespace
}  // namespace relight
