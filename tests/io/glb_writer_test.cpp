#include <gtest/gtest.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <random>

#include "core/display/display.h"
#include "core/io/writers.h"
#include "tests/gltf_checks.h"
#include "tests/io/reader_checks.h"
#include "tests/shapes.h"
#include "tests/written.h"

namespace relight {
namespace {

using test::Glb;

/// Written, and looked at: nothing may be wrong with it. Kept as a file where
/// RELIGHT_KEEP_GLB says, for tests/gltf/validate.
Glb written(const LitMesh& lit, const std::string& name)
{
    const std::string file = write_glb(lit);
    if (const char* folder = std::getenv("RELIGHT_KEEP_GLB")) {
        std::ofstream(std::filesystem::path(folder) / (name + ".glb"), std::ios::binary) << file;
    }
    Glb glb = test::checked_glb(file);
    EXPECT_EQ(glb.faults, std::vector<std::string>{}) << name;
    return glb;
}

std::vector<double> attribute(const Glb& glb, const std::string& name)
{
    const auto& primitive = glb.json["meshes"][0]["primitives"][0];
    return test::numbers_of(glb, primitive["attributes"].at(name).get<std::size_t>());
}

/// Places as a viewer sees them: the node's translation plus the numbers, in double.
std::vector<Point3> positions(const Glb& glb)
{
    const auto node = glb.json["nodes"][0];
    const std::vector<double> shift = node.value("translation", std::vector<double>{0.0, 0.0, 0.0});
    const std::vector<double> p = attribute(glb, "POSITION");
    std::vector<Point3> places;
    for (std::size_t i = 0; i < p.size(); i += 3) {
        places.push_back({shift[0] + p[i], shift[1] + p[i + 1], shift[2] + p[i + 2]});
    }
    return places;
}

std::vector<Rgb8> codes(std::size_t count)
{
    std::vector<Rgb8> all;
    for (std::size_t i = 0; i < count; ++i) {
        const auto code = static_cast<unsigned char>(i);
        all.push_back({code, static_cast<unsigned char>(255 - code), 17});
    }
    return all;
}

std::vector<float> ramp(std::size_t count)
{
    std::vector<float> values(count);
    for (std::size_t i = 0; i < count; ++i) { values[i] = 0.1F * static_cast<float>(i); }
    return values;
}

/// A float mesh of random places within 1 of `centre`.
Mesh scattered(Point3 centre, std::size_t count)
{
    std::mt19937 random(11);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    const auto as_float = [](double x) { return static_cast<double>(static_cast<float>(x)); };
    Mesh mesh;
    mesh.format = "ply";
    for (std::size_t i = 0; i < count; ++i) {
        mesh.positions.push_back({as_float(centre.x + any(random)),
                                  as_float(centre.y + any(random)),
                                  as_float(centre.z + any(random))});
    }
    return mesh;
}

TEST(GlbWriter, EveryFileOfMeshesAndCloudsBecomesAGlbWithNothingWrong)
{
    std::size_t files = 0;
    for (const char* folder : {"meshes", "clouds"}) {
        for (const auto& entry : std::filesystem::directory_iterator(
                 std::filesystem::path(RELIGHT_TEST_DATA) / folder)) {
            const std::string bytes = test::contents(entry.path());
            const auto format = mesh_format_of_bytes(std::as_bytes(std::span(bytes)));
            if (!format || entry.path().extension() == ".laz") { continue; }
            Progress progress;
            const auto mesh =
                read_mesh(*format, std::as_bytes(std::span(bytes)), ReadLimits{}, progress);
            if (!mesh) { continue; }
            const std::size_t count = mesh->positions.size();
            const std::vector<Rgb8> color = codes(count);
            const std::vector<float> E = ramp(3 * count), ao = ramp(count);
            const Glb glb = written(
                {*mesh, {}, color, {{"irradiance", 3, E}, {"ambient_occlusion", 1, ao}}, {}},
                entry.path().filename());
            EXPECT_EQ(attribute(glb, "POSITION").size(), 3 * count);
            EXPECT_EQ(attribute(glb, "_IRRADIANCE"), std::vector<double>(E.begin(), E.end()));
            ++files;
        }
    }
    EXPECT_GT(files, 35U);
}

TEST(GlbWriter, FloatPositionsComeBackExactlyWhereverTheMeshStands)
{
    for (const Point3 centre : {Point3{0, 0, 0}, Point3{0.5, -2, 3}, Point3{1000, 0, -30},
                                Point3{500000, 4649000, 120}, Point3{1e9, -1e9, 1e14}}) {
        const Mesh mesh = scattered(centre, 300);
        EXPECT_EQ(positions(written({mesh, {}, {}, {}, {}}, "float")), mesh.positions) << centre.x;
    }
}

TEST(GlbWriter, DoublePositionsMoveByLessThanAMillionthOfTheExtent)
{
    for (const double far : {0.0, 1.0, 7.0, 15.0, 17.0, 1e3, 4649000.0, 1e9}) {
        Mesh mesh = test::icosphere(2);
        for (Point3& p : mesh.positions) { p = p + Vec3{far, -far, 0.3 * far}; }
        const std::vector<Point3> back = positions(written({mesh, {}, {}, {}, {}}, "double"));
        for (std::size_t i = 0; i < back.size(); ++i) {
            EXPECT_LT(length(back[i] - mesh.positions[i]), 2.0 * 1e-6) << far;
        }
    }
}

TEST(GlbWriter, AFlatMeshFarOutKeepsItsHeight)
{
    Mesh mesh = test::grid(2);
    for (Point3& p : mesh.positions) { p.z = 1234.567; }
    for (const Point3 p : positions(written({mesh, {}, {}, {}, {}}, "flat"))) {
        EXPECT_NEAR(p.z, 1234.567, 1e-12 * 1234.567);
    }
}

TEST(GlbWriter, EachMaterialHasAPrimitiveOfTheTrianglesThatPrepareMakes)
{
    Mesh mesh = test::box({0, 0, 0}, {1, 1, 1});
    mesh.positions.insert(mesh.positions.end(), {{0, 0, 2}, {4, 0, 2}, {1, 1, 2}, {0, 4, 2}});
    // A concave quad, two triangles, a convex quad: a fan of the first would leave its outline.
    mesh.faces.indices = {10, 11, 8, 9, 0, 2, 1, 0, 3, 2, 4, 5, 6, 7};
    mesh.faces.offsets = {0, 4, 7, 10, 14};
    mesh.materials = {"stone", "unused", "wood"};
    mesh.face_materials = {2, 0, 2, 0};
    Progress progress;
    const Surface surface = prepare(mesh, 1, progress);
    std::array<std::vector<double>, 3> expected;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        auto& group = expected.at(mesh.face_materials[surface.triangle_face[t]]);
        group.insert(group.end(), surface.triangles[t].begin(), surface.triangles[t].end());
    }

    const Glb glb = written({mesh, {}, {}, {}, {}}, "materials");
    const auto& primitives = glb.json["meshes"][0]["primitives"];
    ASSERT_EQ(primitives.size(), 2U);
    for (const auto& primitive : primitives) {
        const std::size_t material = primitive["material"];
        EXPECT_EQ(test::numbers_of(glb, primitive["indices"]), expected.at(material));
        EXPECT_EQ(primitive["attributes"], primitives[0]["attributes"]);
    }
    EXPECT_EQ(glb.json["materials"][2]["name"], "wood");
    EXPECT_TRUE(glb.json["materials"][2]["extensions"].contains("KHR_materials_unlit"));
}

TEST(GlbWriter, IndicesTakeTwoBytesUpToTheirLastValueThatIsNoRestart)
{
    for (const std::size_t vertices : {65535U, 65536U}) {
        Mesh mesh = scattered({0, 0, 0}, vertices);
        const auto last = static_cast<std::uint32_t>(vertices - 1);
        mesh.faces.indices = {0, 1, last};
        const Glb glb = written({mesh, {}, {}, {}, {}}, "indices" + std::to_string(vertices));
        const std::size_t indices = glb.json["meshes"][0]["primitives"][0]["indices"];
        EXPECT_EQ(test::numbers_of(glb, indices), (std::vector<double>{0, 1, double(last)}));
        EXPECT_EQ(glb.json["accessors"][indices]["componentType"], vertices == 65535 ? 5123 : 5125);
    }
}

TEST(GlbWriter, ColorIsTheLinearValueOfItsCodes)
{
    const Mesh mesh = scattered({0, 0, 0}, 256);
    const std::vector<Rgb8> color = codes(256);
    const std::vector<double> linear =
        attribute(written({mesh, {}, color, {}, {}}, "color"), "COLOR_0");
    ASSERT_EQ(linear.size(), 3 * color.size());
    for (std::size_t i = 0; i < linear.size(); ++i) {
        const double code = color[i / 3][i % 3];
        EXPECT_NEAR(linear[i], srgb_eotf(code / 255.0), 1e-7);
        EXPECT_EQ(to_code(srgb_oetf(linear[i])), color[i / 3][i % 3]);
    }
}

TEST(GlbWriter, TheFilesOwnColoursStayWhereNoneWereMadeUpToGltfsOne)
{
    Mesh mesh = scattered({0, 0, 0}, 3);
    mesh.colors = {{0.25F, 0.5F, 1.0F}, {0.0F, 1.5F, 0.0F}, {0.1F, 0.2F, 0.3F}};
    const std::vector<double> back = attribute(written({mesh, {}, {}, {}, {}}, "own"), "COLOR_0");
    for (std::size_t i = 0; i < 9; ++i) {
        EXPECT_EQ(back[i], std::min(1.0, static_cast<double>(mesh.colors[i / 3][i % 3])));
    }
}

TEST(GlbWriter, AbsentPointsAreThereButCannotBeSeen)
{
    Mesh mesh = scattered({0, 0, 0}, 4);
    mesh.absent = {1, 3};
    const std::vector<Rgb8> color = codes(4);
    const Glb glb = written({mesh, {}, color, {}, {}}, "absent");
    const std::vector<double> rgba = attribute(glb, "COLOR_0");
    ASSERT_EQ(rgba.size(), 16U);
    for (std::size_t i = 0; i < 4; ++i) { EXPECT_EQ(rgba[4 * i + 3], i % 2 == 0 ? 1.0 : 0.0); }
    EXPECT_EQ(glb.json["materials"][0]["alphaMode"], "MASK");
    EXPECT_EQ(glb.json["meshes"][0]["primitives"][0]["mode"], 0);
}

TEST(GlbWriter, EachQuantityIsAnAttributeWithANameOfItsOwn)
{
    const Mesh mesh = scattered({0, 0, 0}, 3);
    const std::vector<float> three = {0.1F, -0.0F, 1e-38F, 3.4e38F, 1e-45F, 5, 6, 7, 8};
    const std::vector<float> one = {9, 10, 11}, other = {12, 13, 14};
    const Glb glb = written({mesh,
                             {},
                             {},
                             {{"per_light_Key", 3, three},
                              {"visibility_lamp.1", 1, one},
                              {"visibility_LAMP_1", 1, other}},
                             {}},
                            "names");
    const auto wide = [](const std::vector<float>& v) {
        return std::vector<double>(v.begin(), v.end());
    };
    EXPECT_EQ(attribute(glb, "_PER_LIGHT_KEY"), wide(three));
    EXPECT_EQ(attribute(glb, "_VISIBILITY_LAMP_1"), wide(one));
    EXPECT_EQ(attribute(glb, "_VISIBILITY_LAMP_1_"), wide(other));
}

TEST(GlbWriter, NormalsAreUnitAndThoseThatAreNotThereAreSaid)
{
    Mesh mesh = scattered({0, 0, 0}, 3);
    mesh.normals = {{0, 3, 4}, {0, 0, 0}, {1e-300, 0, 0}};
    const Glb filed = written({mesh, {}, {}, {}, {}}, "normals");
    const std::vector<double> n = attribute(filed, "NORMAL");
    EXPECT_NEAR(n[1], 0.6, 1e-7);
    EXPECT_EQ(std::vector<double>(n.begin() + 3, n.begin() + 6), (std::vector<double>{0, 0, 1}));
    EXPECT_NE(filed.json["asset"]["extras"]["relight"][0].get<std::string>().find("NORMAL of 1 "),
              std::string::npos);

    const std::vector<Dir3> lit(3, normalize({1, 0, 0}));
    const Glb given = written({mesh, lit, {}, {}, {}}, "normals");
    EXPECT_EQ(attribute(given, "NORMAL"), (std::vector<double>{1, 0, 0, 1, 0, 0, 1, 0, 0}));
    EXPECT_FALSE(given.json["asset"].contains("extras"));
}

TEST(GlbWriter, TextureCoordinatesRunDownThePictureWhateverTheFormat)
{
    Mesh mesh = scattered({0, 0, 0}, 1);
    mesh.uvs = {{0.25F, 0.125F}};
    EXPECT_EQ(attribute(written({mesh, {}, {}, {}, {}}, "uv"), "TEXCOORD_0"),
              (std::vector<double>{0.25, 0.875}));
    mesh.format = "glb";
    EXPECT_EQ(attribute(written({mesh, {}, {}, {}, {}}, "uv"), "TEXCOORD_0"),
              (std::vector<double>{0.25, 0.125}));
}

TEST(GlbWriter, WhatGltfHasNoPlaceForIsLeftOutAndSaid)
{
    Mesh mesh = scattered({0, 0, 0}, 3);
    mesh.faces.indices = {0, 1, 2};
    mesh.corner_uvs = {{0, 0}, {1, 0}, {0, 1}};
    const Glb glb = written({mesh, {}, {}, {}, {"irradiance in W/m2"}}, "corners");
    const auto& said = glb.json["asset"]["extras"]["relight"];
    EXPECT_EQ(said[0], "irradiance in W/m2");
    EXPECT_NE(said[1].get<std::string>().find("texture coordinates are left out"),
              std::string::npos);
    EXPECT_FALSE(glb.json["meshes"][0]["primitives"][0]["attributes"].contains("TEXCOORD_0"));
}

TEST(GlbWriter, NamesOfAnyBytesAreJson)
{
    Mesh mesh = scattered({0, 0, 0}, 3);
    mesh.faces.indices = {0, 1, 2};
    mesh.materials = {"a \"quoted\" \\ name", std::string("tab\there\0null", 13), "caf\xE9",
                      "\xE2\x98\x83"};
    mesh.face_materials = {3};
    const auto materials = written({mesh, {}, {}, {}, {}}, "bytes").json["materials"];
    EXPECT_EQ(materials[0]["name"], mesh.materials[0]);
    EXPECT_EQ(materials[1]["name"], mesh.materials[1]);
    EXPECT_EQ(materials[2]["name"], "caf\xC3\xA9");
    EXPECT_EQ(materials[3]["name"], mesh.materials[3]);
}

}  // namespace
}  // namespace relight
