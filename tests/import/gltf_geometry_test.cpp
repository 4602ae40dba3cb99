// What the parts of a glTF come to in the world, each against what the specification derives.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/import/gltf_builder.h"

namespace relight::test {
namespace {

using Corners = std::vector<std::uint32_t>;

Mesh mesh_of(const GltfBuilder& gltf)
{
    Result<Asset> asset = decode(gltf);
    EXPECT_TRUE(asset) << detail_of(asset);
    if (!asset) { return {}; }
    EXPECT_TRUE(keeps_promises(*asset));
    return std::move(asset->mesh);
}

void expect_near(Vec3 a, Vec3 b, double tolerance = 1e-6)
{
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

void expect_near(Point3 a, Point3 b, double tolerance = 1e-6)
{
    expect_near(a - Point3{}, b - Point3{}, tolerance);
}

bool notes_say(const Mesh& mesh, std::string_view words)
{
    return std::any_of(mesh.notes.begin(), mesh.notes.end(), [&](const std::string& note) {
        return note.find(words) != std::string::npos;
    });
}

/// Five points of a zigzag, drawn by `mode`.
Corners corners_drawn(int mode, const Json& indices)
{
    GltfBuilder gltf;
    Json primitive{{"mode", mode},
                   {"attributes",
                    {{"POSITION", gltf.accessor<float>(
                                      {0, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 2, 0, 0}, "VEC3")}}}};
    if (!indices.is_null()) {
        primitive["indices"] = gltf.accessor(indices.get<std::vector<std::uint8_t>>(), "SCALAR");
    }
    gltf.mesh(primitive);
    gltf.json["nodes"] = Json::array({{{"mesh", 0}}});
    const Mesh mesh = mesh_of(gltf);
    EXPECT_EQ(mesh.positions.size(), 5U);
    return mesh.faces.indices;
}

TEST(GltfPrimitives, StripsAndFansBecomeTheTrianglesOfTheSpecification)  // glTF 2.0, 3.7.2.1
{
    // Strip: p_i = {v_i, v_i+(1+i%2), v_i+(2-i%2)}. Fan: p_i = {v_i+1, v_i+2, v_0}.
    EXPECT_EQ(corners_drawn(5, nullptr), (Corners{0, 1, 2, 1, 3, 2, 2, 3, 4}));
    EXPECT_EQ(corners_drawn(5, {4, 3, 2, 1}), (Corners{4, 3, 2, 3, 1, 2}));
    EXPECT_EQ(corners_drawn(6, nullptr), (Corners{1, 2, 0, 2, 3, 0, 3, 4, 0}));
    EXPECT_EQ(corners_drawn(6, {2, 0, 1, 4}), (Corners{0, 1, 2, 1, 4, 2}));
    EXPECT_EQ(corners_drawn(4, {0, 2, 1, 1, 2, 3}), (Corners{0, 2, 1, 1, 2, 3}));
}

TEST(GltfPrimitives, PointsAndLinesKeepTheirVerticesAndAddNoFaces)
{
    for (const int mode : {0, 1, 2, 3}) { EXPECT_TRUE(corners_drawn(mode, nullptr).empty()); }
    EXPECT_TRUE(corners_drawn(5, {0, 1}).empty());  // a strip too short for one
}

TEST(GltfPrimitives, CornersBehindTheLastTriangleAreNoted)
{
    EXPECT_EQ(corners_drawn(4, {0, 2, 1, 1, 2}), (Corners{0, 2, 1}));
    EXPECT_EQ(corners_drawn(4, nullptr), (Corners{0, 1, 2}));
}

TEST(GltfPrimitives, IntegersAreNormalizedAsTheSpecificationSays)  // 3.6.2.2
{
    GltfBuilder gltf;
    const std::vector<std::int8_t> normals{0, 0, 127, 0, -128, 0, -127, 0, 0};
    const std::vector<std::uint8_t> colors{0, 51, 255, 0, 255, 102, 0, 0, 0, 0, 0, 255};
    const std::vector<std::uint16_t> uvs{0, 65535, 13107, 0, 65535, 0};
    const std::vector<std::int16_t> positions{0, 0, 0, 32767, 0, 0, 0, -32768, 0};
    gltf.mesh({{"attributes",
                {{"POSITION", gltf.accessor(positions, "VEC3", true)},
                 {"NORMAL", gltf.accessor(normals, "VEC3", true)},
                 {"COLOR_0", gltf.accessor(colors, "VEC4", true)},
                 {"TEXCOORD_0", gltf.accessor(uvs, "VEC2", true)},
                 {"TEXCOORD_1", gltf.accessor(uvs, "VEC2")}}}});
    gltf.json["nodes"] = Json::array({{{"mesh", 0}}});
    const Mesh mesh = mesh_of(gltf);
    EXPECT_EQ(mesh.positions, (std::vector<Point3>{{0, 0, 0}, {1, 0, 0}, {0, -1, 0}}));
    EXPECT_EQ(mesh.normals, (std::vector<Vec3>{{0, 0, 1}, {0, -1, 0}, {-1, 0, 0}}));
    EXPECT_EQ(mesh.colors[0], (Rgbf{0.0F, 0.2F, 1.0F}));
    EXPECT_EQ(mesh.colors[1], (Rgbf{1.0F, 0.4F, 0.0F}));
    EXPECT_EQ(mesh.uvs[1], (Uv{0.2F, 0.0F}));
    EXPECT_EQ(mesh.uvs_1[1], (Uv{13107.0F, 0.0F}));  // KHR_mesh_quantization: as they are
}

TEST(GltfPrimitives, AttributesThatOnlySomeHaveAreFilledIn)
{
    GltfBuilder gltf = one_triangle();
    const std::vector<float> up{0, 0, 2, 0, 0, 2, 0, 0, 2}, red{2, 0, 0, 1, 0, 0, 1, -3, 0};
    gltf.json["meshes"][0]["primitives"].push_back({{"attributes",
                                                     {{"POSITION", gltf.accessor(triangle, "VEC3")},
                                                      {"NORMAL", gltf.accessor(up, "VEC3")},
                                                      {"COLOR_0", gltf.accessor(red, "VEC3")}}}});
    const Mesh mesh = mesh_of(gltf);
    ASSERT_EQ(mesh.normals.size(), 6U);
    EXPECT_EQ(mesh.normals[0], (Vec3{}));  // none
    EXPECT_EQ(mesh.normals[3], (Vec3{0, 0, 1}));
    EXPECT_EQ(mesh.colors[0], (Rgbf{1, 1, 1}));
    EXPECT_EQ(mesh.colors[3], (Rgbf{1, 0, 0}));  // clamped to [0, 1]
    EXPECT_EQ(mesh.colors[5], (Rgbf{1, 0, 0}));
    EXPECT_TRUE(mesh.uvs.empty());
    EXPECT_TRUE(notes_say(mesh, "normals are computed smooth"));
}

TEST(GltfScene, NodesMoveTheirChildrenAndNormalsStayNormal)
{
    GltfBuilder gltf = one_triangle();
    // A plane x + y = 1, tilted; its normal (1, 1, 0) / sqrt 2.
    const std::vector<float> tilted{1, 0, 0, 0, 1, 0, 0, 1, 1};
    const auto s = static_cast<float>(std::numbers::sqrt2 / 2.0);
    const std::vector<float> normals{s, s, 0, s, s, 0, s, s, 0};
    const std::vector<float> tangents{s, -s, 0, 1, s, -s, 0, 1, s, -s, 0, -1};
    gltf.json["meshes"][0]["primitives"][0]["attributes"] = {
        {"POSITION", gltf.accessor(tilted, "VEC3")},
        {"NORMAL", gltf.accessor(normals, "VEC3")},
        {"TANGENT", gltf.accessor(tangents, "VEC4")}};
    const double half = std::sqrt(0.5);
    gltf.json["nodes"] = Json::array({{{"children", {1}},
                                       {"translation", {10, 20, 30}},
                                       {"rotation", {0, 0, half, half}}},  // x to y
                                      {{"mesh", 0}, {"scale", {3, 1, 2}}}});
    const Mesh mesh = mesh_of(gltf);
    expect_near(mesh.positions[0], {10, 23, 30});
    expect_near(mesh.positions[1], {9, 20, 30});
    expect_near(mesh.positions[2], {9, 20, 32});
    const Vec3 ng = normalize(
        cross(mesh.positions[1] - mesh.positions[0], mesh.positions[2] - mesh.positions[0]));
    expect_near(mesh.normals[0], ng);
    const auto t = mesh.tangents[0];
    expect_near({t[0], t[1], t[2]}, normalize(mesh.positions[0] - mesh.positions[1]));
    EXPECT_EQ(t[3], 1.0F);
    EXPECT_EQ(mesh.tangents[2][3], -1.0F);
}

TEST(GltfScene, AMirrorTurnsWindingAndBitangentsAndKeepsFronts)
{
    const std::vector<float> normals{0, 0, 1, 0, 0, 1, 0, 0, 1};
    const std::vector<float> tangents{1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1};
    for (const auto& scale : {std::array{-2, 1, 1}, {1, -2, 1}, {1, 1, -2}, {-1, -1, -1}}) {
        GltfBuilder gltf = one_triangle();
        Json& attributes = gltf.json["meshes"][0]["primitives"][0]["attributes"];
        attributes["NORMAL"] = gltf.accessor(normals, "VEC3");
        attributes["TANGENT"] = gltf.accessor(tangents, "VEC4");
        gltf.json["nodes"] = Json::array({{{"mesh", 0}, {"scale", scale}}});
        const Mesh mesh = mesh_of(gltf);
        EXPECT_EQ(mesh.faces.indices, (Corners{0, 2, 1}));
        // A front is where the mirrored front is.
        expect_near(mesh.normals[0], {0, 0, static_cast<double>(scale[2] < 0 ? -1 : 1)});
        const Vec3 ng =
            cross(mesh.positions[2] - mesh.positions[0], mesh.positions[1] - mesh.positions[0]);
        EXPECT_GT(dot(ng, mesh.normals[0]), 0.0);
        // cross(n, t) w follows the image of +y, along which v increases.
        const auto t = mesh.tangents[0];
        const Vec3 bitangent =
            cross(mesh.normals[0], {t[0], t[1], t[2]}) * static_cast<double>(t[3]);
        EXPECT_GT(dot(bitangent, mesh.positions[2] - mesh.positions[0]), 0.0);
    }
}

TEST(GltfScene, AMatrixIsColumnByColumn)
{
    GltfBuilder gltf = one_triangle();
    gltf.json["nodes"] =
        Json::array({{{"mesh", 0}, {"matrix", {0, 2, 0, 0, 0, 0, 3, 0, 4, 0, 0, 0, 5, 6, 7, 1}}}});
    const Mesh mesh = mesh_of(gltf);
    EXPECT_EQ(mesh.positions, (std::vector<Point3>{{5, 6, 7}, {5, 8, 7}, {5, 6, 10}}));
    EXPECT_FALSE(mesh.double_positions);
}

TEST(GltfScene, AScaleOfZeroGivesFiniteNumbersAndNoNormals)
{
    const std::vector<float> normals{0, 0, 1, 0, 0, 1, 1, 0, 0};
    GltfBuilder gltf = one_triangle();
    gltf.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] =
        gltf.accessor(normals, "VEC3");
    for (const auto& scale : {std::array{0, 0, 0}, {0, 0, 1}, {1, 1, 0}, {1, 0, 1}}) {
        gltf.json["nodes"] = Json::array({{{"mesh", 0}, {"scale", scale}}});
        const Mesh mesh = mesh_of(gltf);
        // Flattened to a plane it still has that plane's normal; to a line or point none.
        const double expected = scale == std::array{1, 1, 0} ? 1.0 : 0.0;
        EXPECT_NEAR(length(mesh.normals[0]), expected, 1e-12);
        EXPECT_EQ(mesh.normals[2], (Vec3{}));
    }
}

TEST(GltfScene, TheDefaultSceneIsShownElseTheFirstElseEveryRoot)
{
    GltfBuilder gltf = one_triangle();
    gltf.json["nodes"] =
        Json::array({{{"mesh", 0}}, {{"mesh", 0}, {"children", {2}}}, {{"mesh", 0}}});
    gltf.json["scenes"] = Json::array({{{"nodes", {0}}}, {{"nodes", {1, 0}}}});
    const auto nodes = [&] {
        std::vector<std::uint32_t> shown;
        for (const GltfPiece& piece : mesh_of(gltf).pieces) { shown.push_back(piece.node); }
        return shown;
    };
    gltf.json["scene"] = 1;
    EXPECT_EQ(nodes(), (std::vector<std::uint32_t>{1, 2, 0}));
    gltf.json.erase("scene");
    EXPECT_EQ(nodes(), (std::vector<std::uint32_t>{0}));
    gltf.json.erase("scenes");
    EXPECT_EQ(nodes(), (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(GltfScene, AChainAsLongAsTheFileIsWalked)
{
    GltfBuilder gltf = one_triangle();
    constexpr int depth = 20000;
    for (int i = 0; i < depth; ++i) {
        gltf.json["nodes"][static_cast<std::size_t>(i)] = {{"children", {i + 1}},
                                                           {"translation", {1, 0, 0}}};
    }
    gltf.json["nodes"].push_back({{"mesh", 0}});
    EXPECT_EQ(mesh_of(gltf).positions[0], (Point3{depth, 0, 0}));
}

TEST(GltfScene, DoubleIsKeptWhereFloatWouldLoseTheShape)
{
    GltfBuilder gltf = one_triangle();
    gltf.json["nodes"] =
        Json::array({{{"mesh", 0}, {"translation", {4.5e6, 0, 0}}, {"scale", {0.1, 0.1, 0.1}}}});
    const Mesh mesh = mesh_of(gltf);
    EXPECT_TRUE(mesh.double_positions);
    EXPECT_NEAR(mesh.positions[1].x - 4.5e6, 0.1, 1e-8);
}

TEST(GltfScene, InstancesAreUnfolded)  // EXT_mesh_gpu_instancing: T R S before the node's matrix
{
    GltfBuilder gltf = one_triangle();
    const auto s = static_cast<float>(std::sqrt(0.5));
    const std::vector<float> moves{0, 0, 0, 5, 0, 0}, scales{1, 1, 1, 2, 2, 2};
    const std::vector<float> turns{0, 0, 0, 1, 0, 0, s, s};
    gltf.json["nodes"] = Json::array({{{"mesh", 0},
                                       {"translation", {0, 0, 1}},
                                       {"extensions",
                                        {{"EXT_mesh_gpu_instancing",
                                          {{"attributes",
                                            {{"TRANSLATION", gltf.accessor(moves, "VEC3")},
                                             {"ROTATION", gltf.accessor(turns, "VEC4")},
                                             {"SCALE", gltf.accessor(scales, "VEC3")}}}}}}}}});
    const Mesh mesh = mesh_of(gltf);
    ASSERT_EQ(mesh.pieces.size(), 2U);
    EXPECT_EQ(mesh.pieces[1].instance, 1U);
    EXPECT_EQ(mesh.pieces[1].first_vertex, 3U);
    expect_near(mesh.positions[1], {1, 0, 1});
    expect_near(mesh.positions[4], {5, 2, 1});  // (1,0,0) twice as long, turned to +y
    expect_near(mesh.positions[5], {3, 0, 1});  // (0,1,0) to -x
    EXPECT_EQ(mesh.faces.indices, (Corners{0, 1, 2, 3, 4, 5}));
}

TEST(GltfScene, MorphTargetsAreAddedWithTheWeightsOfTheNodeElseOfTheMesh)
{
    GltfBuilder gltf = one_triangle();
    const std::vector<float> up{0, 0, 1, 0, 0, 1, 0, 0, 1}, along{0, 0, 0, 4, 0, 0, 0, 0, 0};
    gltf.json["meshes"][0]["primitives"][0]["targets"] = {
        {{"POSITION", gltf.accessor(up, "VEC3")}}, {{"POSITION", gltf.accessor(along, "VEC3")}}};
    EXPECT_EQ(mesh_of(gltf).positions[1], (Point3{1, 0, 0}));
    gltf.json["meshes"][0]["weights"] = {0.5, 0.25};
    EXPECT_EQ(mesh_of(gltf).positions[1], (Point3{2, 0, 0.5}));
    gltf.json["nodes"][0]["weights"] = {2, 0};
    EXPECT_EQ(mesh_of(gltf).positions[1], (Point3{1, 0, 2}));
    EXPECT_TRUE(notes_say(mesh_of(gltf), "morph targets"));
}

/// The triangle on two joints, at x = 10 and y = 10, whose bind poses were the origin and (0, 5,
/// 0).
GltfBuilder skinned()
{
    GltfBuilder gltf = one_triangle();
    const std::vector<std::uint8_t> joints{0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0};
    const std::vector<float> weights{1, 0, 0, 0, 1, 0, 0, 0, 0.5F, 0.5F, 0, 0};
    const std::vector<float> inverse{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,
                                     1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -5, 0, 1};
    Json& attributes = gltf.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] = gltf.accessor(joints, "VEC4");
    attributes["WEIGHTS_0"] = gltf.accessor(weights, "VEC4");
    gltf.json["skins"] = Json::array(
        {{{"joints", {1, 2}}, {"inverseBindMatrices", gltf.accessor(inverse, "MAT4")}}});
    gltf.json["nodes"] = Json::array({{{"mesh", 0}, {"skin", 0}, {"translation", {99, 99, 99}}},
                                      {{"translation", {10, 0, 0}}},
                                      {{"translation", {0, 10, 0}}}});
    gltf.json["scenes"] = Json::array({{{"nodes", {0, 1, 2}}}});
    return gltf;
}

TEST(GltfScene, ASkinStandsWhereItsJointsAreAndNotWhereItsNodeIs)
{
    const Mesh mesh = mesh_of(skinned());
    EXPECT_EQ(mesh.positions[0], (Point3{10, 0, 0}));
    EXPECT_EQ(mesh.positions[1], (Point3{1, 5, 0}));    // (1,0,0) - (0,5,0) + (0,10,0)
    EXPECT_EQ(mesh.positions[2], (Point3{5, 3.5, 0}));  // halfway of (10,1,0) and (0,6,0)
    EXPECT_TRUE(notes_say(mesh, "skins"));
}

TEST(GltfScene, AJointThatTheSkinLacksIsRefusedUnlessItsWeightIsZero)
{
    GltfBuilder gltf = skinned();
    gltf.json["skins"][0] = {{"joints", {1}}};
    const Result<Asset> asset = decode(gltf);
    ASSERT_FALSE(asset);
    EXPECT_EQ(asset.error().fault, Fault::IndexOutOfRange);
}

TEST(GltfMaterials, AFaceWithoutOneGetsGltfsDefault)
{
    GltfBuilder gltf = one_triangle();
    Result<Asset> asset = decode(gltf);
    ASSERT_TRUE(asset) << detail_of(asset);
    EXPECT_EQ(asset->mesh.materials, std::vector<std::string>{"default"});
    EXPECT_EQ(asset->materials.at(0).metallic, 1.0);
    EXPECT_EQ(asset->materials.at(0).roughness, 1.0);
    gltf.json["materials"] = {
        {{"name", "default"}, {"pbrMetallicRoughness", {{"metallicFactor", 0}}}}};
    gltf.json["meshes"][0]["primitives"].push_back(gltf.json["meshes"][0]["primitives"][0]);
    gltf.json["meshes"][0]["primitives"][1]["material"] = 0;
    asset = decode(gltf);
    ASSERT_TRUE(asset) << detail_of(asset);
    EXPECT_EQ(asset->mesh.materials, (std::vector<std::string>{"default", "default_"}));
    EXPECT_EQ(asset->mesh.face_materials, (std::vector<std::uint32_t>{1, 0}));
    EXPECT_EQ(asset->materials.at(0).metallic, 0.0);
    EXPECT_TRUE(keeps_promises(*asset));
}

TEST(GltfFile, AGlbSaysWhatItsGltfSays)
{
    const GltfBuilder gltf = skinned();
    const Result<Asset> glb = decode(gltf.glb()), text = decode("\xEF\xBB\xBF" + gltf.text());
    ASSERT_TRUE(glb) << detail_of(glb);
    ASSERT_TRUE(text) << detail_of(text);
    EXPECT_EQ(glb->mesh.format, "glb");
    EXPECT_EQ(text->mesh.format, "gltf");
    EXPECT_EQ(glb->mesh.positions, text->mesh.positions);
}

TEST(GltfFile, ViewsMayBeInterleavedAndUnaligned)
{
    GltfBuilder gltf;
    // x y z and two bytes of colour that nobody asked for, 16 bytes apart, from byte 1 on.
    std::vector<std::uint8_t> bytes(1 + 3 * 16, 0xFF);
    for (std::size_t i = 0; i < 3; ++i) { std::memcpy(&bytes[1 + 16 * i], &triangle[3 * i], 12); }
    const std::size_t view = gltf.view(bytes);
    gltf.json["bufferViews"][view]["byteStride"] = 16;
    gltf.json["accessors"] = Json::array({{{"bufferView", view},
                                           {"byteOffset", 1},
                                           {"componentType", 5126},
                                           {"count", 3},
                                           {"type", "VEC3"}}});
    gltf.mesh({{"attributes", {{"POSITION", 0}}}});
    gltf.json["nodes"] = Json::array({{{"mesh", 0}}});
    EXPECT_EQ(mesh_of(gltf).positions, (std::vector<Point3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
}

TEST(GltfFile, WhatIsPassedOverIsNoted)
{
    GltfBuilder gltf = one_triangle();
    gltf.json["extensionsUsed"] = {"KHR_mesh_quantization", "VENDOR_thing"};
    const Mesh mesh = mesh_of(gltf);
    EXPECT_TRUE(notes_say(mesh, "VENDOR_thing"));
    EXPECT_FALSE(notes_say(mesh, "KHR_mesh_quantization"));
}

}  // namespace
}  // namespace relight::test
