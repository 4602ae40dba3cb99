// decode(encode(x)) = x: what our GLBs say, read by our own importer's decoder.
#include <gtest/gtest.h>

#include <cmath>

#include "core/display/display.h"
#include "core/io/readers.h"
#include "server/gltf_answer.h"
#include "server/import/gltf.h"
#include "tests/server/gltf_files.h"
#include "tests/shapes.h"
#include "tests/written.h"

namespace relight {
namespace {

Result<Asset> decoded(std::string_view file)
{
    return decode_gltf(std::as_bytes(std::span(file)), GltfLimits{});
}

std::vector<Rgb8> codes(std::size_t count)
{
    std::vector<Rgb8> all;
    for (std::size_t i = 0; i < count; ++i) {
        all.push_back({static_cast<unsigned char>(i), static_cast<unsigned char>(i >> 8U), 200});
    }
    return all;
}

void expect_colors(const Mesh& mesh, const std::vector<Rgb8>& color, const std::string& name)
{
    ASSERT_EQ(mesh.colors.size(), color.size()) << name;
    for (std::size_t i = 0; i < color.size(); ++i) {
        const Rgb expected = srgb_eotf(color[i]);
        ASSERT_NEAR(static_cast<double>(mesh.colors[i][0]), expected.r, 1e-7) << name;
        ASSERT_NEAR(static_cast<double>(mesh.colors[i][1]), expected.g, 1e-7) << name;
        ASSERT_NEAR(static_cast<double>(mesh.colors[i][2]), expected.b, 1e-7) << name;
    }
}

TEST(GltfRoundTrip, AnAnsweredFileIsTheSameMeshInOurColours)
{
    std::size_t files = 0;
    for (const auto& path : test::gltf_files()) {
        const std::string file = test::sent(path), name = path.filename();
        const Result<Asset> before = decoded(file);
        ASSERT_TRUE(before) << name << ": " << (before ? "" : before.error().detail);
        const Mesh& mesh = before->mesh;
        const std::vector<Rgb8> color = codes(mesh.positions.size());
        const auto answer =
            add_to_gltf(std::as_bytes(std::span(file)), LitMesh{mesh, {}, color, {}, {}})
                .transform(whole);
        ASSERT_TRUE(answer) << name << ": " << answer.error().detail;
        test::keep(name + ".decoded.answer.glb", *answer);
        test::keep(name + (file.starts_with("glTF") ? ".decoded.sent.glb" : ".decoded.sent.gltf"),
                   file);
        const Result<Asset> after = decoded(*answer);
        ASSERT_TRUE(after) << name << ": " << after.error().detail;
        EXPECT_EQ(after->mesh.positions, mesh.positions) << name;
        EXPECT_EQ(after->mesh.faces.indices, mesh.faces.indices) << name;
        EXPECT_EQ(after->mesh.normals, mesh.normals) << name;
        EXPECT_EQ(after->mesh.uvs, mesh.uvs) << name;
        EXPECT_EQ(after->mesh.materials, mesh.materials) << name;
        EXPECT_EQ(after->mesh.face_materials, mesh.face_materials) << name;
        EXPECT_EQ(after->lights.size(), before->lights.size()) << name;
        expect_colors(after->mesh, color, name);
        ++files;
    }
    EXPECT_GT(files, 20U);
}

/// A triangle, three times by EXT_mesh_gpu_instancing under a node that is scaled and moved.
std::string instanced()
{
    const std::vector<float> floats{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 2, 3, 4, 5,
                                    6, 7, 8, 9, 1, 1, 1, 2, 3, 4, 1, 1, -1};
    std::string binary(reinterpret_cast<const char*>(floats.data()), 4 * floats.size());
    for (const int q : {0, 0, 0, 127, 0, 127, 0, 0, 90, 0, 0, 90}) {
        binary += static_cast<char>(q);
    }
    return test::glb_of(test::GltfJson::parse(R"({
        "asset": {"version": "2.0"}, "extensionsUsed": ["EXT_mesh_gpu_instancing"],
        "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "scale": [2, 2, 3], "translation": [10, 0, 0], "extensions":
            {"EXT_mesh_gpu_instancing": {"attributes":
                {"TRANSLATION": 1, "SCALE": 2, "ROTATION": 3}}}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
             "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 1, "byteOffset": 36, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 2, "componentType": 5120, "normalized": true, "count": 3,
             "type": "VEC4"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 72},
            {"buffer": 0, "byteOffset": 108, "byteLength": 12}],
        "buffers": [{"byteLength": 120}]})"),
                        binary);
}

TEST(GltfRoundTrip, UnfoldedInstancesStandWhereTheInstancesStood)
{
    const std::string file = instanced();
    const Result<Asset> before = decoded(file);
    ASSERT_TRUE(before) << before.error().detail;
    ASSERT_EQ(before->mesh.positions.size(), 9U);
    const std::vector<Rgb8> color = codes(9);
    const auto answer =
        add_to_gltf(std::as_bytes(std::span(file)), LitMesh{before->mesh, {}, color, {}, {}})
            .transform(whole);
    ASSERT_TRUE(answer) << answer.error().detail;
    EXPECT_EQ(test::checked_glb(*answer).faults, std::vector<std::string>{});
    const Result<Asset> after = decoded(*answer);
    ASSERT_TRUE(after) << after.error().detail;
    ASSERT_EQ(after->mesh.positions.size(), 9U);
    for (std::size_t i = 0; i < 9; ++i) {
        EXPECT_LT(length(after->mesh.positions[i] - before->mesh.positions[i]), 1e-5) << i;
    }
    EXPECT_EQ(after->mesh.faces.indices, before->mesh.faces.indices);
    expect_colors(after->mesh, color, "instances");
}

TEST(GltfRoundTrip, AWrittenMeshComesBackWithItsMaterialsAndColours)
{
    Mesh mesh = test::box({100, 0, 0}, {101, 1, 1});
    mesh.format = "ply";
    mesh.double_positions = false;
    mesh.materials = {"stone", "wood"};
    mesh.face_materials = {0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1};
    const std::vector<Rgb8> color = codes(8);
    const std::string file = write_glb({mesh, {}, color, {}, {}});
    const Result<Asset> back = decoded(file);
    ASSERT_TRUE(back) << back.error().detail;
    // A primitive a material, each with all the vertices.
    ASSERT_EQ(back->mesh.positions.size(), 16U);
    EXPECT_EQ(back->mesh.materials, mesh.materials);
    EXPECT_EQ(back->mesh.face_materials, mesh.face_materials);
    for (std::size_t c = 0; c < mesh.faces.indices.size(); ++c) {
        const std::uint32_t i = back->mesh.faces.indices[c];
        EXPECT_EQ(i % 8, mesh.faces.indices[c]);
        EXPECT_EQ(back->mesh.positions[i], mesh.positions[i % 8]);
    }
    std::vector<Rgb8> twice = color;
    twice.insert(twice.end(), color.begin(), color.end());
    expect_colors(back->mesh, twice, "box");
}

TEST(GltfRoundTrip, EveryMeshFileComesBackVertexForVertex)
{
    std::size_t files = 0;
    for (const auto& entry :
         std::filesystem::directory_iterator(std::filesystem::path(RELIGHT_TEST_DATA) / "meshes")) {
        const std::string bytes = test::contents(entry.path()), name = entry.path().filename();
        const auto format = mesh_format_of_bytes(std::as_bytes(std::span(bytes)));
        if (!format) { continue; }
        Progress progress;
        const auto mesh = read_mesh(*format, std::as_bytes(std::span(bytes)), {}, progress);
        if (!mesh || mesh->materials.size() > 1 || !mesh->faces.offsets.empty()) { continue; }
        const std::vector<Rgb8> color = codes(mesh->positions.size());
        const Result<Asset> back = decoded(write_glb({*mesh, {}, color, {}, {}}));
        ASSERT_TRUE(back) << name << ": " << back.error().detail;
        ASSERT_EQ(back->mesh.positions.size(), mesh->positions.size()) << name;
        double largest = 0.0;
        for (const Point3 p : mesh->positions) {
            largest = std::max(largest, length(p - Point3{}));
        }
        for (std::size_t i = 0; i < mesh->positions.size(); ++i) {
            ASSERT_LT(length(back->mesh.positions[i] - mesh->positions[i]), 2e-7 * largest) << name;
        }
        EXPECT_EQ(back->mesh.faces.indices, mesh->faces.indices) << name;
        EXPECT_EQ(back->mesh.normals.size(), mesh->normals.size()) << name;
        expect_colors(back->mesh, color, name);
        ++files;
    }
    EXPECT_GT(files, 15U);
}

}  // namespace
}  // namespace relight
