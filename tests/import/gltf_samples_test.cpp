// Files that others made: what tests/data/SOURCES.md says of them, and what they must come to.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/import/gltf_builder.h"

namespace relight::test {
namespace {

std::string sample(const std::string& name)
{
    return name.ends_with(".gltf")
               ? whole_gltf(name)
               : file_bytes(std::filesystem::path(RELIGHT_TEST_DATA) / "gltf" / name);
}

Asset asset_of(const std::string& name)
{
    Result<Asset> asset = decode(sample(name));
    EXPECT_TRUE(asset) << name << ": " << detail_of(asset);
    return asset ? *std::move(asset) : Asset{};
}

/// Vertices and faces of the file, each primitive once however many nodes show it: as a validator
/// counts them. Which faces are a piece's, their vertices say.
std::pair<std::size_t, std::size_t> counts_once(const std::string& file, const Mesh& mesh)
{
    const bool glb = file.starts_with("glTF");
    std::uint32_t length = 0;
    if (glb) { std::memcpy(&length, file.data() + 12, 4); }
    const Json json = Json::parse(glb ? file.substr(20, length) : file);
    std::vector<bool> counted(mesh.positions.size());
    std::set<std::pair<int, std::uint32_t>> seen;
    std::size_t vertices = 0;
    for (const GltfPiece& piece : mesh.pieces) {
        const int shown = json["nodes"][piece.node]["mesh"];
        if (!seen.insert({shown, piece.primitive}).second) { continue; }
        vertices += piece.vertices;
        std::fill_n(counted.begin() + piece.first_vertex, piece.vertices, true);
    }
    std::size_t faces = 0;
    for (std::size_t f = 0; f < mesh.faces.count(); ++f) {
        faces += counted[mesh.faces.indices[3 * f]] ? 1 : 0;
    }
    return {vertices, faces};
}

TEST(GltfSamples, HaveTheVerticesAndFacesThatTheirTableSays)
{
    std::ifstream table(std::string(RELIGHT_TEST_DATA) + "/SOURCES.md");
    std::size_t files = 0;
    bool ours = false;
    for (std::string line; std::getline(table, line);) {
        if (line.starts_with("## ")) { ours = line == "## gltf/"; }
        if (!ours || line.find(".gl") == std::string::npos) { continue; }
        std::istringstream cells(line);
        std::string none, name, about, counts;
        std::getline(cells, none, '|');
        std::getline(cells, name, '|');
        std::getline(cells, about, '|');
        std::getline(cells, counts, '|');
        name = name.substr(1, name.size() - 2);
        std::size_t vertices = 0, faces = 0;
        ASSERT_EQ(std::sscanf(counts.c_str(), " %zu / %zu", &vertices, &faces), 2) << line;
        const Asset asset = asset_of(name);
        EXPECT_EQ(counts_once(sample(name), asset.mesh), std::pair(vertices, faces)) << name;
        EXPECT_TRUE(keeps_promises(asset)) << name;
        ++files;
    }
    EXPECT_GE(files, 26U);
}

/// How many faces turn their front the way that their first corner's normal points.
std::size_t fronts_along_normals(const Mesh& mesh)
{
    std::size_t count = 0;
    for (std::size_t f = 0; f < mesh.faces.count(); ++f) {
        const std::uint32_t* const corner = &mesh.faces.indices[3 * f];
        const Point3 a = mesh.positions[corner[0]];
        const Vec3 ng = cross(mesh.positions[corner[1]] - a, mesh.positions[corner[2]] - a);
        count += dot(ng, mesh.normals[corner[0]]) > 0.0 ? 1 : 0;
    }
    return count;
}

TEST(GltfSamples, HaveFrontsThatNormalsAgreeWith)
{
    for (const char* const name :
         {"ShapeCollection.glb", "nested.glb", "suzi_draco.glb", "SpecularTest.glb",
          "AnimatedMorphCube/AnimatedMorphCube.gltf"}) {
        const Mesh mesh = asset_of(name).mesh;
        EXPECT_EQ(fronts_along_normals(mesh), mesh.faces.count()) << name;
        for (const Vec3& n : mesh.normals) { ASSERT_NEAR(length(n), 1.0, 1e-12) << name; }
    }
}

TEST(GltfSamples, AMirroredNodeKeepsItsFront)  // scaled by -1 in x
{
    const Mesh mesh = asset_of("one_face_123_mirror.gltf").mesh;
    // In the file the corners run 0 1 2 at x = 1, 2.00006, 3.
    EXPECT_EQ(mesh.faces.indices, (std::vector<std::uint32_t>{0, 2, 1}));
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(mesh.positions[i].x, -1.0 - static_cast<double>(i), 1e-4);
    }
}

TEST(GltfSamples, SparseElementsReplaceThoseOfTheirView)  // Khronos' picture: three points rise
{
    const Mesh mesh = asset_of("SimpleSparseAccessor/SimpleSparseAccessor.gltf").mesh;
    for (std::size_t i = 0; i < 7; ++i) {
        EXPECT_EQ(mesh.positions[i], (Point3{static_cast<double>(i), 0.0, 0.0}));
    }
    EXPECT_EQ(mesh.positions[8], (Point3{1.0, 2.0, 0.0}));
    EXPECT_EQ(mesh.positions[10], (Point3{3.0, 3.0, 0.0}));
    EXPECT_EQ(mesh.positions[12], (Point3{5.0, 4.0, 0.0}));
}

std::vector<std::array<double, 3>> sorted_corners(const Mesh& mesh)
{
    std::vector<std::array<double, 3>> corners;
    for (const std::uint32_t i : mesh.faces.indices) {
        const Point3 p = mesh.positions[i];
        corners.push_back({p.x, p.y, p.z});
    }
    std::sort(corners.begin(), corners.end());
    return corners;
}

TEST(GltfSamples, ACompressedBoxIsThePlainBox)  // meshopt, quantized to 14 bits
{
    const Mesh packed = asset_of("BoxMeshopt.glb").mesh,
               plain = asset_of("BoxVertexColors.glb").mesh;
    const auto a = sorted_corners(packed), b = sorted_corners(plain);
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) { EXPECT_NEAR(a[i][k], b[i][k], 1e-4); }
    }
    EXPECT_EQ(fronts_along_normals(packed), 12U);
}

TEST(GltfSamples, DracoGivesTheBoundsThatItsAccessorsSay)
{
    const std::string file = sample("suzi_draco.glb");
    std::uint32_t size = 0;
    std::memcpy(&size, file.data() + 12, 4);
    const Json json = Json::parse(file.substr(20, size));
    const std::size_t index = json["meshes"][0]["primitives"][0]["attributes"]["POSITION"];
    const Json& bounds = json["accessors"][index];
    const auto scale = json["nodes"][0].value("scale", std::vector<double>{1, 1, 1});
    const Mesh mesh = asset_of("suzi_draco.glb").mesh;
    std::array<double, 3> low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};
    for (const Point3& p : mesh.positions) {
        const std::array<double, 3> at{p.x, p.y, p.z};
        for (std::size_t k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], at[k]);
            high[k] = std::max(high[k], at[k]);
        }
    }
    for (std::size_t k = 0; k < 3; ++k) {  // its quantization moves them by less than this
        EXPECT_NEAR(low[k], bounds["min"][k].get<double>() * scale[k], 1e-3);
        EXPECT_NEAR(high[k], bounds["max"][k].get<double>() * scale[k], 1e-3);
    }
}

TEST(GltfSamples, ShowTheLightsOfTheScene)
{
    EXPECT_EQ(asset_of("geometry-camera-light.glb").lights.size(), 2U);
    EXPECT_EQ(asset_of("sphere_lights/sphere_lights.gltf").lights.size(), 4U);
    EXPECT_TRUE(asset_of("nested.glb").lights.empty());
}

TEST(GltfSamples, VertexColoursMultiplyTheBaseColour)
{
    const Asset asset = asset_of("BoxVertexColors.glb");
    ASSERT_EQ(asset.mesh.colors.size(), 24U);
    ASSERT_EQ(asset.materials.size(), 1U);
    EXPECT_TRUE(asset.materials[0].base_color_from_vertex);
    EXPECT_FALSE(asset_of("nested.glb").materials.at(0).base_color_from_vertex);
}

}  // namespace
}  // namespace relight::test
