// Files that are wrong, and thousands that became so: an answer that keeps its promises or a
// refusal that says why, never a crash and no memory for what is only claimed.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/import/gltf_builder.h"
#include "tests/io/mutants.h"

namespace relight::test {
namespace {

/// Small, as no file here is large: claims beyond are refused before anything is allocated.
constexpr GltfLimits small{2'000'000, 2'000'000, 1U << 20U};

/// A GLB's JSON and its BIN chunk.
std::pair<Json, std::string> opened(const std::string& glb)
{
    std::uint32_t length = 0;
    std::memcpy(&length, glb.data() + 12, 4);
    return {Json::parse(glb.substr(20, length)), glb.substr(28 + length)};
}

void expect_refused(const GltfBuilder& gltf, Fault fault, std::string_view words,
                    const GltfLimits& limits = small)
{
    const Result<Asset> asset = decode(gltf, limits);
    ASSERT_FALSE(asset) << words;
    EXPECT_EQ(fault_code(asset.error().fault), fault_code(fault)) << asset.error().detail;
    EXPECT_NE(asset.error().detail.find(words), std::string::npos) << asset.error().detail;
}

std::string broken_promise_of(const Result<Asset>& asset)
{
    if (asset) { return keeps_promises(*asset) ? "" : "an asset that breaks a promise"; }
    const std::string& detail = asset.error().detail;
    const bool printable =
        std::all_of(detail.begin(), detail.end(), [](char c) { return c >= ' ' && c <= '~'; });
    return detail.empty() || !printable ? "an error without a readable text" : "";
}

std::string broken_promise_of(std::string_view bytes)
{
    return broken_promise_of(decode(bytes, small));
}

TEST(GltfRefusals, EveryBrokenFileIsRefusedOrComesToFiniteNumbers)
{
    const std::filesystem::path folder = std::string(RELIGHT_TEST_DATA) + "/broken";
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const std::string name = entry.path().filename();
        if (!name.ends_with(".gltf") && !name.ends_with(".glb")) { continue; }
        ++files;
        const std::string bytes = file_bytes(entry.path());
        const Result<Asset> asset = decode(bytes, small);
        EXPECT_EQ(broken_promise_of(asset), "") << name;
        // A mesh without extent is a mesh: README there allows it.
        EXPECT_EQ(asset.has_value(), name == "a_gltf_zero_scale.gltf") << name;
    }
    EXPECT_EQ(files, 33);
}

TEST(GltfRefusals, NameTheFileThatIsNotReadAndSayWhatToSend)
{
    GltfBuilder gltf = one_triangle();
    const auto refused = [&](const std::string& uri) {
        Json json = gltf.json;
        json["buffers"] = Json::array({{{"byteLength", 36}, {"uri", uri}}});
        return detail_of(decode(json.dump(), small));
    };
    const std::string detail = refused("../secret.bin");
    EXPECT_NE(detail.find("/buffers/0/uri: names the file \"../secret.bin\""), std::string::npos);
    EXPECT_NE(detail.find("send one GLB"), std::string::npos);
    EXPECT_LT(refused(std::string(5000, 'x')).size(), 300U);
    EXPECT_EQ(refused("a\x01\n\xC3\xA9").find('\xC3'), std::string::npos);
    EXPECT_NE(refused("data:text/plain,abc").find(";base64"), std::string::npos);
    for (const char* const bad : {"AAA", "AA=A", "A===", "AAAA AAAA", "AAA!", "===="}) {
        EXPECT_NE(refused(std::string("data:;base64,") + bad).find("not padded base64"),
                  std::string::npos)
            << bad;
    }
    EXPECT_NE(refused("data:;base64,AAAA").find("the data have 3 bytes"), std::string::npos);
}

TEST(GltfRefusals, RequiredExtensionsThatWeLackAreNamed)
{
    GltfBuilder gltf = one_triangle();
    gltf.json["extensionsRequired"] = {"KHR_texture_transform", "KHR_texture_basisu"};
    expect_refused(gltf, Fault::NotAvailable, "KHR_texture_basisu");
}

TEST(GltfRefusals, AnotherVersionIsNamed)
{
    GltfBuilder gltf = one_triangle();
    gltf.json["asset"]["version"] = "1.0";
    expect_refused(gltf, Fault::MalformedHeader, "\"1.0\"");
}

TEST(GltfRefusals, AGlbsLengthsAndChunksMustAddUp)
{
    const std::string glb = one_triangle().glb();
    const auto code = [](const std::string& bytes) {
        const Result<Asset> asset = decode(bytes, small);
        return asset ? "read" : std::string(fault_code(asset.error().fault));
    };
    const auto with_chunk = [&](std::string_view type) {
        std::string longer = glb + std::string("\4\0\0\0", 4) + std::string(type) + "1234";
        longer[8] = static_cast<char>(longer[8] + 12);
        return longer;
    };
    ASSERT_LT(static_cast<unsigned char>(glb[8]), 240);  // so that one byte holds the new length
    EXPECT_EQ(code(glb), "read");
    EXPECT_EQ(code(with_chunk("MORE")), "read");  // unknown chunks are passed over
    EXPECT_EQ(code(with_chunk({"BIN\0", 4})), "malformed_header");
    EXPECT_EQ(code(with_chunk("JSON")), "malformed_header");
    EXPECT_EQ(code(glb + "tail"), "malformed_header");
    EXPECT_EQ(code(glb.substr(0, glb.size() - 4)), "truncated");
    std::string first = glb;
    first[4] = 1;
    EXPECT_EQ(code(first), "malformed_header");
}

TEST(GltfRefusals, LimitsHoldForInstancesUnfoldedBeforeAnythingIsAllocated)
{
    GltfBuilder gltf = one_triangle();
    gltf.json["accessors"].push_back({{"componentType", 5126},
                                      {"count", 6'148'914'691'236'517'206U},
                                      {"type", "VEC3"}});  // three times this is 2
    gltf.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = 1;
    expect_refused(gltf, Fault::TooManyVertices, "/nodes/0");
    gltf.json["nodes"] = Json::array();
    gltf.json["scenes"] = Json::array({{{"nodes", Json::array()}}});
    for (std::size_t i = 0; i < 11; ++i) {
        gltf.json["nodes"].push_back({{"mesh", 0}});
        gltf.json["scenes"][0]["nodes"].push_back(i);
    }
    expect_refused(gltf, Fault::TooManyVertices, "more than 32", {32, 1000, 1000});
    expect_refused(gltf, Fault::TooManyFaces, "more than 10", {33, 10, 1000});
    EXPECT_TRUE(decode(gltf, {33, 11, 1000}));
}

TEST(GltfRefusals, AViewMustHoldItsElements)
{
    GltfBuilder gltf = one_triangle();
    gltf.json["accessors"][0]["byteOffset"] = 4;
    expect_refused(gltf, Fault::CountExceedsFile, "/accessors/0");
    gltf.json["accessors"][0]["byteOffset"] = 18'446'744'073'709'551'615U;
    expect_refused(gltf, Fault::CountExceedsFile, "/accessors/0");
    gltf.json["accessors"][0].erase("byteOffset");
    gltf.json["bufferViews"][0]["byteStride"] = 8;
    expect_refused(gltf, Fault::MalformedBody, "overlap");
    gltf.json["bufferViews"][0]["byteStride"] = 256;
    expect_refused(gltf, Fault::OutOfRange, "/bufferViews/0/byteStride");
    gltf.json["bufferViews"][0].erase("byteStride");
    gltf.json["bufferViews"][0]["byteOffset"] = 18'446'744'073'709'551'600U;
    expect_refused(gltf, Fault::CountExceedsFile, "/bufferViews/0");
}

TEST(GltfRefusals, SparseIndicesMustIncreaseWithinTheAccessor)
{
    for (const auto& indices : {std::vector<std::uint8_t>{1, 1}, {2, 1}, {1, 3}}) {
        GltfBuilder gltf = one_triangle();
        const std::vector<float> values{9, 9, 9, 8, 8, 8};
        const std::size_t where = gltf.view(indices), what = gltf.view(values);
        gltf.json["accessors"][0]["sparse"] = {
            {"count", 2},
            {"indices", {{"bufferView", where}, {"componentType", 5121}}},
            {"values", {{"bufferView", what}}}};
        expect_refused(gltf, Fault::IndexOutOfRange, "/accessors/0/sparse/indices");
    }
}

TEST(GltfRefusals, AttributesMustBeAsManyAsThePositions)
{
    GltfBuilder gltf = one_triangle();
    gltf.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] =
        gltf.accessor<float>({0, 0, 1, 1}, "VEC2");
    expect_refused(gltf, Fault::MalformedBody, "/meshes/0/primitives/0/attributes/TEXCOORD_0");
}

TEST(GltfRefusals, NodesFormATree)
{
    GltfBuilder gltf = one_triangle();
    gltf.json["nodes"] =
        Json::array({{{"children", {1}}}, {{"children", {2}}}, {{"mesh", 0}, {"children", {1}}}});
    expect_refused(gltf, Fault::MalformedBody, "child of node 0 already");
    gltf.json["nodes"] = Json::array({{{"mesh", 0}}, {{"children", {2}}}, {{"children", {1}}}});
    expect_refused(gltf, Fault::MalformedBody, "its own descendant");
    gltf.json["nodes"] = Json::array({{{"mesh", 0}, {"children", {1}}}, Json::object()});
    gltf.json["scenes"][0]["nodes"] = {0, 1};
    expect_refused(gltf, Fault::MalformedBody, "/scenes/0/nodes");
}

TEST(GltfRefusals, CoordinatesBeyondAllMeasureAreRefused)
{
    for (const double far : {2e15, 1e59, 1e300}) {
        GltfBuilder gltf = one_triangle();
        gltf.json["nodes"][0]["scale"] = {far, 1, 1};
        expect_refused(gltf, Fault::CoordinateTooLarge, "/nodes/0");
    }
}

TEST(GltfRefusals, CompressedViewsMustFitTheirBytes)
{
    const auto with = [](const std::string& key, const Json& value) {
        auto [json, binary] =
            opened(contents(std::string(RELIGHT_TEST_DATA) + "/gltf/BoxMeshopt.glb"));
        json["bufferViews"][1]["extensions"]["EXT_meshopt_compression"][key] = value;
        const Result<Asset> asset = decode(GltfBuilder::glb_of(json.dump(), binary), small);
        return asset ? "read" : std::string(fault_code(asset.error().fault));
    };
    EXPECT_EQ(with("count", 24), "read");
    EXPECT_EQ(with("count", 2'000'000'000), "count_exceeds_file");
    EXPECT_EQ(with("count", 18'446'744'073'709'551'615U), "count_exceeds_file");
    EXPECT_EQ(with("count", 300), "malformed_body");
    EXPECT_EQ(with("byteStride", 0), "out_of_range");
    EXPECT_EQ(with("byteStride", 12), "malformed_body");  // the view's own is 8
    EXPECT_EQ(with("mode", "TRIANGLES"), "out_of_range");
    EXPECT_EQ(with("filter", "OTHER"), "malformed_body");
    EXPECT_EQ(with("buffer", 1), "not_available");  // the fallback, which has no bytes
}

/// All that a file can have, in few bytes.
GltfBuilder rich()
{
    GltfBuilder gltf = one_triangle();
    const std::vector<float> up{0, 0, 1, 0, 0, 1, 0, 0, 1};
    const std::vector<float> along{1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, -1};
    const std::vector<std::uint8_t> bytes{0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0}, picked{1};
    const std::vector<float> weights{1, 0, 0, 0, .5F, .5F, 0, 0, 0, 1, 0, 0}, value{0, 2, 0};
    Json& primitive = gltf.json["meshes"][0]["primitives"][0];
    primitive["attributes"]["NORMAL"] = gltf.accessor(up, "VEC3");
    primitive["attributes"]["TANGENT"] = gltf.accessor(along, "VEC4");
    primitive["attributes"]["COLOR_0"] = gltf.accessor(bytes, "VEC4", true);
    primitive["attributes"]["JOINTS_0"] = gltf.accessor(bytes, "VEC4");
    primitive["attributes"]["WEIGHTS_0"] = gltf.accessor(weights, "VEC4");
    primitive["indices"] = gltf.accessor<std::uint16_t>({2, 1, 0}, "SCALAR");
    primitive["material"] = 0;
    primitive["targets"] = {{{"POSITION", gltf.accessor(up, "VEC3")}}};
    gltf.json["meshes"][0]["weights"] = {0.5};
    const std::size_t where = gltf.view(picked), what = gltf.view(value);
    gltf.json["accessors"][0]["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", where}, {"componentType", 5121}}},
        {"values", {{"bufferView", what}}}};
    gltf.json["materials"] = {{{"pbrMetallicRoughness", {{"metallicFactor", 0.5}}}}};
    gltf.json["skins"] = {{{"joints", {0, 1}}}};
    gltf.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
    gltf.json["nodes"] = {
        {{"mesh", 0}, {"skin", 0}, {"rotation", {0, 0, 0.6, 0.8}}, {"scale", {1, -2, 3}}},
        {{"mesh", 0},
         {"extensions",
          {{"KHR_lights_punctual", {{"light", 0}}},
           {"EXT_mesh_gpu_instancing",
            {{"attributes", {{"TRANSLATION", gltf.accessor(up, "VEC3")}}}}}}}}};
    gltf.json["scenes"] = {{{"nodes", {0, 1}}}};
    return gltf;
}

TEST(GltfMutants, AreReadOrRefused)
{
    const auto check = [](std::string_view bytes) { return broken_promise_of(bytes); };
    ASSERT_TRUE(decode(rich())) << detail_of(decode(rich()));
    EXPECT_EQ(broken_promise_of_mutants(check, rich().glb(), 1500, 1), "");
    EXPECT_EQ(broken_promise_of_mutants(check, rich().text(), 1500, 2), "");
    const std::string data = std::string(RELIGHT_TEST_DATA) + "/gltf/";
    EXPECT_EQ(broken_promise_of_mutants(check, contents(data + "BoxMeshopt.glb"), 1000, 3), "");
    EXPECT_EQ(broken_promise_of_mutants(check, contents(data + "suzi_draco.glb"), 300, 4), "");
}

/// Edits of one value at a time: every number extreme, every kind another, every member gone.
TEST(GltfMutants, OfTheValuesOfTheirJsonAreReadOrRefused)
{
    const Json others{nullptr,
                      true,
                      -1,
                      0,
                      1,
                      2,
                      3,
                      255,
                      4294967295U,
                      0.5,
                      1e15,
                      1e308,
                      -1e308,
                      "",
                      "VEC4",
                      "x",
                      Json::array(),
                      Json::object(),
                      5121,
                      5123,
                      5125,
                      5126,
                      Json::array({0, 1}),
                      18446744073709551615U};
    const std::string data = std::string(RELIGHT_TEST_DATA) + "/gltf/";
    for (const std::string& glb :
         {rich().glb(), contents(data + "BoxMeshopt.glb"), contents(data + "suzi_draco.glb")}) {
        const auto parts = opened(glb);
        const Json& json = parts.first;
        // Every value, and all that each lies in, once.
        std::set<std::string> places;
        const Json flat = json.flatten();
        for (const auto& [leaf, ignored] : flat.items()) {
            for (Json::json_pointer at(leaf); !at.empty(); at.pop_back()) {
                places.insert(at.to_string());
            }
        }
        int read = 0;
        const auto check = [&](const Json& mutant) {
            const auto asset = decode(GltfBuilder::glb_of(mutant.dump(), parts.second), small);
            read += asset ? 1 : 0;
            return broken_promise_of(asset);
        };
        for (const std::string& place : places) {
            const Json::json_pointer at(place);
            for (const Json& other : others) {
                Json mutant = json;
                mutant[at] = other;
                ASSERT_EQ(check(mutant), "") << place << " made " << other;
            }
            Json mutant = json;
            Json& parent = mutant[at.parent_pointer()];
            if (parent.is_object()) { parent.erase(at.back()); }
            ASSERT_EQ(check(mutant), "") << "without " << place;
        }
        EXPECT_GT(read, 100);  // else they never come as far as the decoders
    }
}

/// Edits that keep the container whole, so that the bytes inside reach their decoders.
TEST(GltfMutants, OfCompressedBytesAloneAreReadOrRefused)
{
    for (const char* const name : {"BoxMeshopt.glb", "suzi_draco.glb"}) {
        const std::string file = contents(std::string(RELIGHT_TEST_DATA) + "/gltf/" + name);
        const std::size_t from = file.size() - opened(file).second.size();
        std::mt19937 random(5);
        for (int i = 0; i < 400; ++i) {
            std::string mutant = file;
            for (std::size_t edits = 1 + random() % 4; edits > 0; --edits) {
                const std::size_t among = mutant.size() - from;
                // Headers of the streams come first, and lead the decoders furthest astray.
                const std::size_t at = from + random() % (random() % 2 == 0 ? among : among / 64);
                mutant[at] = static_cast<char>(random());
            }
            ASSERT_EQ(broken_promise_of(mutant), "") << name << ", mutant " << i;
        }
    }
}

}  // namespace
}  // namespace relight::test
