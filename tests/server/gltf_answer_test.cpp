#include "server/gltf_answer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/display/display.h"
#include "tests/server/gltf_files.h"

namespace relight {
namespace {

using Json = test::GltfJson;
using test::base64;
using test::Glb;
using test::glb_of;
using test::gltf_files;
using test::sent;

/// What was sent, as the GLB that it would be if nothing were added.
Glb as_glb(const std::string& file)
{
    return test::checked_glb(file.starts_with("glTF") ? file : glb_of(Json::parse(file), ""));
}

std::size_t vertices_of(const Json& json, const Json& primitive)
{
    return json["accessors"].at(primitive["attributes"]["POSITION"].get<std::size_t>())["count"];
}

/// A walk through the scene, depth first, by this test's own reading.
void walk(const Json& json, std::size_t index, std::vector<GltfPiece>& pieces)
{
    const Json& node = json["nodes"].at(index);
    if (node.contains("mesh")) {
        std::size_t instances = 1;
        const Json::json_pointer instancing("/extensions/EXT_mesh_gpu_instancing/attributes");
        if (node.contains(instancing)) {
            instances = json["accessors"].at(node[instancing].begin()->get<std::size_t>())["count"];
        }
        const Json& primitives = json["meshes"].at(node["mesh"].get<std::size_t>())["primitives"];
        for (std::uint32_t instance = 0; instance < instances; ++instance) {
            for (std::uint32_t p = 0; p < primitives.size(); ++p) {
                const std::uint32_t first =
                    pieces.empty() ? 0 : pieces.back().first_vertex + pieces.back().vertices;
                pieces.push_back({static_cast<std::uint32_t>(index), p, instance, first,
                                  static_cast<std::uint32_t>(vertices_of(json, primitives[p]))});
            }
        }
    }
    for (const std::size_t child : node.value("children", std::vector<std::size_t>{})) {
        walk(json, child, pieces);
    }
}

/// Something computed for each vertex of a file, different for each.
struct Lit {
    Mesh mesh;
    std::vector<Rgb8> color;
    std::vector<float> irradiance, occlusion;

    explicit Lit(const Json& json)
    {
        mesh.format = "glb";
        for (const std::size_t root : json["scenes"].at(json.value("scene", 0U))["nodes"]) {
            walk(json, root, mesh.pieces);
        }
        const std::size_t count = mesh.pieces.back().first_vertex + mesh.pieces.back().vertices;
        mesh.positions.resize(count);
        for (std::size_t i = 0; i < count; ++i) {
            const auto code = static_cast<unsigned char>(i);
            color.push_back({code, static_cast<unsigned char>(i >> 8U), 99});
            const auto x = static_cast<float>(i);
            irradiance.insert(irradiance.end(), {x, 0.5F * x, 0.1F});
            occlusion.push_back(1.0F / (1.0F + x));
        }
    }
    LitMesh lit() const
    {
        return {mesh,
                {},
                color,
                {{"irradiance", 3, irradiance}, {"ambient_occlusion", 1, occlusion}},
                {"irradiance in W/m2"}};
    }
};

/// The answer to a file, looked at: nothing may be wrong with it that was not before.
Glb answered(const std::string& file, const LitMesh& lit, const std::string& name)
{
    const Result<std::string> answer =
        add_to_gltf(std::as_bytes(std::span(file)), lit).transform(whole);
    EXPECT_TRUE(answer) << name << ": " << (answer ? "" : answer.error().detail);
    if (!answer) { return {}; }
    test::keep(name + ".answer.glb", *answer);
    test::keep(name + (file.starts_with("glTF") ? ".sent.glb" : ".sent.gltf"), file);
    Glb glb = test::checked_glb(*answer);
    const std::vector<std::string> before = as_glb(file).faults;
    std::vector<std::string> added;
    for (const std::string& fault : glb.faults) {
        if (std::find(before.begin(), before.end(), fault) == before.end()) {
            added.push_back(fault);
        }
    }
    EXPECT_EQ(added, std::vector<std::string>{}) << name;
    return glb;
}

/// Every vertex of every piece has what was computed for it, on a mesh that no other node shows.
void expect_lit(const Glb& glb, const Lit& lit, const std::string& name)
{
    std::map<std::size_t, std::size_t> shown;
    for (const Json& node : glb.json["nodes"]) {
        if (node.contains("mesh")) { ++shown[node["mesh"]]; }
    }
    const LitMesh given = lit.lit();
    for (const GltfPiece& piece : lit.mesh.pieces) {
        const Json& node = glb.json["nodes"].at(piece.node);
        const bool unfolded = !node.contains("mesh");
        const Json& shower =
            unfolded ? glb.json["nodes"].at(
                           node["children"][node["children"].size() - 1 -
                                            (lit.mesh.pieces.back().instance - piece.instance)]
                               .get<std::size_t>())
                     : node;
        const std::size_t mesh = shower.at("mesh");
        EXPECT_EQ(shown[mesh], 1U) << name;
        const Json& attributes =
            glb.json["meshes"][mesh]["primitives"].at(piece.primitive)["attributes"];
        const auto linear = test::numbers_of(glb, attributes.at("COLOR_0"));
        const auto E = test::numbers_of(glb, attributes.at("_IRRADIANCE"));
        const auto ao = test::numbers_of(glb, attributes.at("_AMBIENT_OCCLUSION"));
        ASSERT_EQ(linear.size(), 3U * piece.vertices) << name;
        ASSERT_EQ(ao.size(), piece.vertices) << name;
        for (std::size_t i = 0; i < piece.vertices; ++i) {
            const std::size_t v = piece.first_vertex + i;
            const Rgb expected = srgb_eotf(lit.color[v]);
            ASSERT_NEAR(linear[3 * i], expected.r, 1e-7) << name;
            ASSERT_NEAR(linear[3 * i + 1], expected.g, 1e-7) << name;
            ASSERT_NEAR(linear[3 * i + 2], expected.b, 1e-7) << name;
            ASSERT_EQ(E[3 * i], static_cast<double>(lit.irradiance[3 * v])) << name;
            ASSERT_EQ(ao[i], static_cast<double>(lit.occlusion[v])) << name;
        }
    }
    EXPECT_EQ(glb.json["asset"]["extras"]["relight"], Json(given.comments)) << name;
}

/// Every member of `before` is in `after`, but for those that the answer has to change.
void expect_kept(const Json& before, const Json& after, const std::string& at)
{
    if (!before.is_structured()) {
        EXPECT_EQ(before, after) << at;
        return;
    }
    for (const auto& [key, value] : before.items()) {
        std::string here = at;
        here.append("/").append(key);
        if (key == "COLOR_0" || here == "/buffers/0/byteLength" ||
            (key == "mesh" && at.starts_with("/nodes"))) {
            continue;
        }
        const bool there = after.is_object() ? after.contains(key)
                                             : after.is_array() && std::stoul(key) < after.size();
        ASSERT_TRUE(there) << here;
        expect_kept(value, after.is_object() ? after[key] : after[std::stoul(key)], here);
    }
}

TEST(GltfAnswer, EveryVertexOfEveryFileHasWhatWasComputedForIt)
{
    const auto files = gltf_files();
    EXPECT_GT(files.size(), 20U);
    for (const auto& path : files) {
        const std::string file = sent(path);
        const Lit lit(as_glb(file).json);
        expect_lit(answered(file, lit.lit(), path.filename()), lit, path.filename());
    }
}

TEST(GltfAnswer, AllThatCameInStaysByteForByte)
{
    for (const auto& path : gltf_files()) {
        const std::string file = sent(path);
        const Glb before = as_glb(file);
        if (!file.starts_with("glTF")) { continue; }
        const Lit lit(before.json);
        const Glb after = answered(file, lit.lit(), path.filename());
        expect_kept(before.json, after.json, "");
        for (std::size_t n = 0; n < before.json["nodes"].size(); ++n) {
            const Json &node = before.json["nodes"][n], &now = after.json["nodes"][n];
            EXPECT_EQ(node.contains("mesh"), now.contains("mesh"));
            if (!node.contains("mesh")) { continue; }
            expect_kept(before.json["meshes"][node["mesh"].get<std::size_t>()],
                        after.json["meshes"][now["mesh"].get<std::size_t>()], path.filename());
        }
        const auto length = before.json["buffers"][0]["byteLength"].get<std::size_t>();
        EXPECT_EQ(after.binary.substr(0, length), before.binary.substr(0, length)) << path;
    }
}

/// One triangle shown in many ways: 0 and 1 show mesh 0, 2 shows it as three instances and has a
/// child, 3 is not in the scene. Buffer 0 has three floats times three, then the instances.
struct Triangle {
    Json json = Json::parse(R"({
        "asset": {"version": "2.0", "extras": {"mine": 1}},
        "extensionsUsed": ["EXT_mesh_gpu_instancing", "VENDOR_unknown"],
        "extensionsRequired": ["EXT_mesh_gpu_instancing"],
        "scene": 0,
        "scenes": [{"nodes": [0, 1, 2]}, {"nodes": [3]}],
        "nodes": [
            {"mesh": 0},
            {"mesh": 0, "extras": [1, {"a": null}], "translation": [5, 0, 0]},
            {"mesh": 0, "children": [4], "extensions": {"EXT_mesh_gpu_instancing":
                {"attributes": {"TRANSLATION": 1, "ROTATION": 2}}}},
            {"mesh": 0}, {"name": "child"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "COLOR_0": 0}}],
            "extras": {"deep": [[[0.1]]]}, "extensions": {"VENDOR_unknown": {"keep": true}}}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
             "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 2, "componentType": 5120, "normalized": true, "count": 3,
             "type": "VEC4"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 36},
            {"buffer": 0, "byteOffset": 72, "byteLength": 12}],
        "buffers": [{"byteLength": 84}]})");
    std::string binary;

    Triangle()
    {
        const std::vector<float> floats{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
        binary.assign(reinterpret_cast<const char*>(floats.data()), 72);
        // A rotation each: none, half a turn around y, 90 degrees around x (to 1/127).
        for (const int q : {0, 0, 0, 127, 0, 127, 0, 0, 90, 0, 0, 90}) {
            binary += static_cast<char>(q);
        }
    }
    std::string as_text() const
    {
        Json inside = json;
        inside["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64(binary);
        return inside.dump();
    }
};

TEST(GltfAnswer, NodesThatShareAMeshAndInstancesAreEachLitAlone)
{
    const Triangle triangle;
    for (const std::string& file : {glb_of(triangle.json, triangle.binary), triangle.as_text()}) {
        const Lit lit(triangle.json);
        ASSERT_EQ(lit.mesh.pieces.size(), 5U);
        const Glb glb = answered(file, lit.lit(), "instances");
        expect_lit(glb, lit, "instances");
        const Json& nodes = glb.json["nodes"];
        ASSERT_EQ(nodes.size(), 8U);
        EXPECT_EQ(nodes[2]["children"], Json({4, 5, 6, 7}));
        EXPECT_FALSE(nodes[2].contains("extensions"));
        EXPECT_EQ(nodes[6]["translation"], Json({4.0, 5.0, 6.0}));
        EXPECT_EQ(nodes[6]["rotation"], Json({0.0, 1.0, 0.0, 0.0}));
        EXPECT_NEAR(nodes[7]["rotation"][0].get<double>(), std::sqrt(0.5), 1e-15);
        EXPECT_FALSE(nodes[7].contains("scale"));
        EXPECT_EQ(glb.json["extensionsUsed"], Json({"VENDOR_unknown"}));
        EXPECT_FALSE(glb.json.contains("extensionsRequired"));
        for (const Json& mesh : glb.json["meshes"]) {
            EXPECT_EQ(mesh["extensions"], triangle.json["meshes"][0]["extensions"]);
            EXPECT_EQ(mesh["extras"], triangle.json["meshes"][0]["extras"]);
            EXPECT_EQ(mesh["primitives"][0]["attributes"]["POSITION"], 0);
        }
        EXPECT_EQ(glb.json["asset"]["extras"]["mine"], 1);
        EXPECT_EQ(nodes[1]["extras"], triangle.json["nodes"][1]["extras"]);
        EXPECT_EQ(nodes[3], triangle.json["nodes"][3]) << "in no scene that was lit";
        EXPECT_EQ(glb.json["meshes"][0], triangle.json["meshes"][0]);
    }
}

TEST(GltfAnswer, InstancesWithoutAViewAreZeroAndCompressedOnesAreDeclined)
{
    Triangle triangle;
    triangle.json["accessors"][1].erase("bufferView");
    const Lit lit(triangle.json);
    const Glb glb = answered(glb_of(triangle.json, triangle.binary), lit.lit(), "zeros");
    EXPECT_EQ(glb.json["nodes"][7]["translation"], Json({0.0, 0.0, 0.0}));

    triangle.json["bufferViews"][2]["extensions"]["EXT_meshopt_compression"]["buffer"] = 0;
    const std::string file = glb_of(triangle.json, triangle.binary);
    const auto answer = add_to_gltf(std::as_bytes(std::span(file)), lit.lit());
    ASSERT_FALSE(answer);
    EXPECT_EQ(answer.error().fault, Fault::NotAvailable);
    EXPECT_NE(answer.error().detail.find("ply"), std::string::npos);
}

TEST(GltfAnswer, ATextsBuffersMoveUpByOneAndOursIsTheBinaryChunk)
{
    Triangle triangle;
    Json& view = triangle.json["bufferViews"][0];
    view["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0}, {"byteLength", 36}};
    triangle.json["extensionsUsed"].push_back("EXT_meshopt_compression");
    const Lit lit(triangle.json);
    const Glb glb = answered(triangle.as_text(), lit.lit(), "text");
    ASSERT_EQ(glb.json["buffers"].size(), 2U);
    EXPECT_FALSE(glb.json["buffers"][0].contains("uri"));
    EXPECT_EQ(glb.json["buffers"][0]["byteLength"], glb.binary.size());
    EXPECT_EQ(glb.json["buffers"][1]["uri"], Json::parse(triangle.as_text())["buffers"][0]["uri"]);
    EXPECT_EQ(glb.json["bufferViews"][0]["buffer"], 1);
    EXPECT_EQ(glb.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["buffer"], 1);
    EXPECT_EQ(glb.json["bufferViews"][3]["buffer"], 0);
}

TEST(GltfAnswer, ABufferOfAnyLengthAndChunksBehindItStay)
{
    Triangle triangle;
    triangle.binary += "odd";
    triangle.json["buffers"][0]["byteLength"] = triangle.binary.size();
    const std::string rest = std::string("\4\0\0\0XTRAdata", 12);
    const Lit lit(triangle.json);
    const Glb glb = answered(glb_of(triangle.json, triangle.binary, rest), lit.lit(), "odd");
    EXPECT_EQ(glb.binary.substr(0, triangle.binary.size()), triangle.binary);
    EXPECT_EQ(glb.rest, rest);
}

TEST(GltfAnswer, DracosOwnColoursDoNotHideOurs)
{
    Triangle triangle;
    Json& primitive = triangle.json["meshes"][0]["primitives"][0];
    primitive["extensions"]["KHR_draco_mesh_compression"] = {
        {"bufferView", 0}, {"attributes", {{"POSITION", 0}, {"COLOR_0", 1}}}};
    triangle.json["extensionsUsed"].push_back("KHR_draco_mesh_compression");
    const Lit lit(triangle.json);
    const Glb glb = answered(glb_of(triangle.json, triangle.binary), lit.lit(), "draco");
    for (const std::size_t node : {0U, 1U, 5U}) {
        const Json& mesh = glb.json["meshes"][glb.json["nodes"][node]["mesh"].get<std::size_t>()];
        EXPECT_EQ(mesh["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"],
                  Json({{"POSITION", 0}}));
    }
}

TEST(GltfAnswer, TheFilesOwnColourStaysWhereNoneWasMade)
{
    const Triangle triangle;
    const Lit lit(triangle.json);
    LitMesh some = lit.lit();
    some.color = {};
    const std::string file = glb_of(triangle.json, triangle.binary);
    EXPECT_EQ(answered(file, some, "no_color")
                  .json["meshes"][1]["primitives"][0]["attributes"]["COLOR_0"],
              0);
    some.quantities.clear();
    const Glb bare = answered(triangle.as_text(), some, "bare");
    EXPECT_EQ(bare.binary, "");
    EXPECT_EQ(bare.json["buffers"].size(), 1U);
}

TEST(GltfAnswer, AnAnswerCanBeAnsweredAgain)
{
    const Triangle triangle;
    const Lit lit(triangle.json);
    const std::string file = glb_of(triangle.json, triangle.binary);
    const std::string once = whole(*add_to_gltf(std::as_bytes(std::span(file)), lit.lit()));
    const Lit again(as_glb(once).json);
    EXPECT_EQ(again.mesh.positions.size(), lit.mesh.positions.size());
    expect_lit(answered(once, again.lit(), "again"), again, "again");
}

TEST(GltfAnswer, AFileThatIsNotTheMeshsIsAnInternalError)
{
    const Triangle good;
    const Lit lit(good.json);
    const auto fault = [&](const Triangle& triangle) {
        const std::string file = glb_of(triangle.json, triangle.binary);
        const auto answer = add_to_gltf(std::as_bytes(std::span(file)), lit.lit());
        return answer ? std::optional<Fault>() : answer.error().fault;
    };
    EXPECT_FALSE(fault(good));
    const auto broken = [&](const char* place, const Json& value) {
        Triangle triangle;
        triangle.json[Json::json_pointer(place)] = value;
        EXPECT_EQ(fault(triangle), Fault::Internal) << place;
    };
    broken("/nodes/0/mesh", 7);
    broken("/nodes/1/mesh", -1);
    broken("/nodes/1/mesh", 1e300);
    broken("/nodes/2/mesh", "0");
    broken("/accessors/0/count", 4);
    broken("/accessors/1/count", 2);
    broken("/accessors/1/componentType", 5125);
    broken("/accessors/1/byteOffset", 1e9);
    broken("/accessors/1/byteOffset", 18446744073709551612ULL);
    broken("/bufferViews/1/byteStride", 18446744073709551612ULL);
    broken("/bufferViews/1/buffer", 1);
    broken("/buffers/0/byteLength", 1000);
    broken("/meshes/0/primitives", Json::object());
    broken("/meshes", nullptr);
    broken("/asset", 3);

    for (const std::string& file :
         {std::string("glTF"), std::string("{"), std::string(), std::string(100000, '['),
          std::string("glTF\2") + std::string(8, '\xFF')}) {
        EXPECT_EQ(add_to_gltf(std::as_bytes(std::span(file)), lit.lit()).error().fault,
                  Fault::Internal);
    }
}

TEST(GltfAnswer, JsonDeeperThanTheImporterTakesIsRefused)
{
    for (const std::size_t depth : {60U, 70U}) {
        Triangle triangle;
        triangle.json["extras"] = Json::parse(std::string(depth, '[') + std::string(depth, ']'));
        const Lit lit(triangle.json);
        const std::string file = glb_of(triangle.json, triangle.binary);
        const auto answer = add_to_gltf(std::as_bytes(std::span(file)), lit.lit());
        EXPECT_EQ(answer.has_value(), depth == 60) << depth;
    }
}

TEST(GltfAnswer, CopiesThatWouldFillTheMemoryAreDeclined)
{
    Triangle triangle;
    triangle.json["meshes"][0]["extras"] = Json::array();
    for (int i = 0; i < 200'000; ++i) {
        triangle.json["meshes"][0]["extras"].push_back("twenty letters and so on");
    }
    const Lit lit(triangle.json);
    const std::string file = glb_of(triangle.json, triangle.binary);
    const auto answer = add_to_gltf(std::as_bytes(std::span(file)), lit.lit());
    ASSERT_FALSE(answer);
    EXPECT_EQ(answer.error().fault, Fault::NotAvailable);
}

}  // namespace
}  // namespace relight
