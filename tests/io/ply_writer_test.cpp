#include <gtest/gtest.h>

#include <cmath>

#include "core/display/display.h"
#include "core/io/writers.h"
#include "tests/io/reader_checks.h"
#include "tests/written.h"

namespace relight {
namespace {

constexpr PlyEncoding encodings[] = {PlyEncoding::BinaryLittleEndian, PlyEncoding::Ascii};

/// Numbers that a careless writer spoils: long fractions, tiny, huge, negative zero.
std::vector<float> awkward_floats(std::size_t count)
{
    std::vector<float> values = {0.1F,        -0.0F,  1e-38F,   3.4e38F,
                                 1.0F / 3.0F, 1e-45F, 65504.0F, 16777216.0F};
    std::mt19937 random(7);
    std::uniform_real_distribution<float> any(-1.0F, 1.0F);
    while (values.size() < count) { values.push_back(any(random)); }
    values.resize(count);
    return values;
}

/// A mesh with everything: mixed polygons, normals, 8-bit colours, both kinds of texture
/// coordinates.
Mesh full_mesh(std::size_t vertices)
{
    Mesh mesh;
    mesh.format = "ply";
    const std::vector<float> f = awkward_floats(8 * vertices + 64);
    for (std::size_t i = 0; i < vertices; ++i) {
        const auto d = [&](std::size_t k) { return static_cast<double>(f[8 * i + k]); };
        mesh.positions.push_back({std::min(d(0), 1e6), d(1), std::min(d(2), 1e6)});
        mesh.normals.push_back({d(3), d(4), d(5)});
        mesh.uvs.push_back({f[8 * i + 6], f[8 * i + 7]});
        mesh.colors.push_back(to_float(srgb_eotf(Rgb8{static_cast<unsigned char>(i), 0, 255})));
    }
    const auto last = static_cast<std::uint32_t>(vertices - 1);
    mesh.faces.indices = {0, 1, 2, 0, 2, 3, last, 1, 2};
    mesh.faces.offsets = {0, 3, 6, 9};
    mesh.faces.indices.insert(mesh.faces.indices.end(), {3, 2, 1, 0});
    mesh.faces.offsets.push_back(13);
    for (std::size_t c = 0; c < mesh.faces.indices.size(); ++c) {
        mesh.corner_uvs.push_back({f[c], f[c + 13]});
    }
    return mesh;
}

Mesh read_back(const std::string& ply)
{
    Result<Mesh> mesh = test::read(read_ply, ply);
    EXPECT_TRUE(mesh) << mesh.error().detail;
    return mesh ? std::move(*mesh) : Mesh{};
}

/// As floats: ascii keeps the decimals of a float, which are read as a double.
template <class T>
std::vector<Rgbf> floats(const std::vector<T>& values)
{
    std::vector<Rgbf> out;
    out.reserve(values.size());
    for (const T& v : values) { out.push_back(to_float(Rgb{v.x, v.y, v.z})); }
    return out;
}

void expect_same(const Mesh& a, const Mesh& b)
{
    if (b.double_positions) { EXPECT_EQ(a.positions, b.positions); }
    EXPECT_EQ(floats(a.positions), floats(b.positions));
    EXPECT_EQ(a.double_positions, b.double_positions);
    EXPECT_EQ(a.faces.indices, b.faces.indices);
    EXPECT_EQ(a.faces.offsets, b.faces.offsets);
    EXPECT_EQ(floats(a.normals), floats(b.normals));
    EXPECT_EQ(a.colors, b.colors);
    EXPECT_EQ(a.uvs, b.uvs);
    EXPECT_EQ(a.corner_uvs, b.corner_uvs);
}

/// The values of one float property, read by giving it the name of a coordinate.
std::vector<float> property(std::string ply, const std::string& type, const std::string& name)
{
    const auto rename = [&](const std::string& from, const std::string& to) {
        const std::size_t at = ply.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        if (at != std::string::npos) { ply.replace(at, from.size(), to); }
    };
    rename(" x\n", " hidden\n");
    rename("property " + type + " " + name + "\n", "property " + type + " x\n");
    const Mesh mesh = read_back(ply);
    std::vector<float> values;
    values.reserve(mesh.positions.size());
    for (const Point3& p : mesh.positions) { values.push_back(static_cast<float>(p.x)); }
    return values;
}

TEST(WritePly, WhatIsWrittenReadsBackTheSame)
{
    for (const PlyEncoding encoding : encodings) {
        Mesh mesh = full_mesh(3000);  // more than a block of records
        expect_same(read_back(write_ply({mesh, {}, {}, {}, {}}, encoding)), mesh);

        mesh.corner_uvs.clear();
        mesh.faces.offsets.clear();
        mesh.faces.indices.resize(9);
        mesh.colors[5] = {0.123F, 4.0F, 0.0F};  // no 8-bit code: all are written as floats
        expect_same(read_back(write_ply({mesh, {}, {}, {}, {}}, encoding)), mesh);

        mesh.positions[7].x = 1234567.890123;
        mesh.double_positions = true;
        expect_same(read_back(write_ply({mesh, {}, {}, {}, {}}, encoding)), mesh);

        mesh.faces = {};  // a cloud
        expect_same(read_back(write_ply({mesh, {}, {}, {}, {}}, encoding)), mesh);
    }
}

TEST(WritePly, ManyTrianglesReadBackTheSame)
{
    Mesh mesh;
    std::mt19937 random(3);
    for (int i = 0; i < 500; ++i) { mesh.positions.push_back({static_cast<double>(i), 0, 0}); }
    for (int i = 0; i < 3 * 5000; ++i) {
        mesh.faces.indices.push_back(static_cast<std::uint32_t>(random() % 500));
    }
    for (const PlyEncoding encoding : encodings) {
        expect_same(read_back(write_ply({mesh, {}, {}, {}, {}}, encoding)), mesh);
    }
}

TEST(WritePly, PolygonsOfMoreThan255CornersKeepThem)
{
    Mesh mesh;
    for (std::uint32_t i = 0; i < 300; ++i) {
        mesh.positions.push_back({std::cos(0.02 * i) > 0 ? 1.0 : 0.0, static_cast<double>(i), 0});
        mesh.faces.indices.push_back(i);
    }
    mesh.faces.offsets = {0, 300};
    for (const PlyEncoding encoding : encodings) {
        expect_same(read_back(write_ply({mesh, {}, {}, {}, {}}, encoding)), mesh);
        mesh.faces.indices.resize(130);  // fits a uchar, twice as many texture coordinates do not
        mesh.faces.offsets = {0, 130};
        mesh.corner_uvs.resize(130, {0.5F, 0.25F});
        expect_same(read_back(write_ply({mesh, {}, {}, {}, {}}, encoding)), mesh);
    }
}

TEST(WritePly, QuantitiesReadBackExactly)
{
    const Mesh mesh = full_mesh(2000);
    std::vector<float> E = awkward_floats(6000), visibility = awkward_floats(2000);
    for (std::vector<float>* values : {&E, &visibility}) {  // read_ply refuses more than 1e15
        for (float& v : *values) { v = std::min(v, 1e14F); }
    }
    const LitMesh lit{mesh, {}, {}, {{"irradiance", 3, E}, {"visibility_key", 1, visibility}}, {}};
    for (const PlyEncoding encoding : encodings) {
        const std::string ply = write_ply(lit, encoding);
        expect_same(read_back(ply), mesh);
        const char* const names[] = {"irradiance_r", "irradiance_g", "irradiance_b"};
        for (std::size_t band = 0; band < 3; ++band) {
            const std::vector<float> values = property(ply, "float", names[band]);
            ASSERT_EQ(values.size(), 2000U);
            for (std::size_t i = 0; i < 2000; ++i) {
                ASSERT_EQ(values[i], E[3 * i + band]) << names[band];
            }
        }
        EXPECT_EQ(property(ply, "float", "visibility_key"), visibility);
    }
}

TEST(WritePly, AskedForColourAndNormalsReplaceTheFiledOnes)
{
    const Mesh mesh = full_mesh(256);
    std::vector<Rgb8> color;
    std::vector<Dir3> normals;
    for (std::size_t i = 0; i < 256; ++i) {
        color.push_back({static_cast<unsigned char>(255 - i), 7, static_cast<unsigned char>(i)});
        normals.push_back(normalize({static_cast<double>(i), 1, 0}));
    }
    normals[3] = {};  // a vertex without one
    for (const PlyEncoding encoding : encodings) {
        const std::string ply = write_ply({mesh, normals, color, {}, {}}, encoding);
        const Mesh back = read_back(ply);
        for (std::size_t i = 0; i < 256; ++i) {
            EXPECT_EQ(back.colors[i], to_float(srgb_eotf(color[i])));
            EXPECT_NEAR(length(back.normals[i] - normals[i]), 0.0, 1e-7);
        }
        EXPECT_EQ(property(ply, "uchar", "blue")[200], 200.0F);
    }
}

TEST(WritePly, MaterialsStayWithTheirFaces)
{
    Mesh mesh = full_mesh(10);
    mesh.materials = {"wall", "a\nproperty list"};
    mesh.face_materials = {1, 0, 0, 1};
    for (const PlyEncoding encoding : encodings) {
        const std::string ply = write_ply({mesh, {}, {}, {}, {}}, encoding);
        EXPECT_NE(ply.find("comment material 0 wall\ncomment material 1 a property list\n"),
                  std::string::npos);
        EXPECT_EQ(read_back(ply).notes.at(0), "skipped properties of 'face': 'material_index'");
    }
}

TEST(WritePly, NoTextOfAClientGetsOutOfItsCommentOrName)
{
    const Mesh mesh = full_mesh(8);
    const std::vector<float> values(8, 0.5F);
    const LitMesh lit{mesh,
                      {},
                      {},
                      {{"visibility_a b\nend_header", 1, values},
                       {"visibility_a-b\nend_header", 1, values},
                       {"x", 1, values},
                       {"lämp", 1, values}},
                      {"units W/m2\r\nend_header\nproperty"}};
    for (const PlyEncoding encoding : encodings) {
        const std::string ply = write_ply(lit, encoding);
        EXPECT_NE(ply.find("\ncomment units W/m2  end_header property\n"), std::string::npos);
        EXPECT_NE(ply.find(" visibility_a_b_end_header\n"), std::string::npos);
        EXPECT_NE(ply.find(" visibility_a_b_end_header_\n"), std::string::npos);
        EXPECT_NE(ply.find(" x_\n"), std::string::npos);
        EXPECT_NE(ply.find(" l__mp\n"), std::string::npos);
        expect_same(read_back(ply), mesh);
    }
}

}  // namespace
}  // namespace relight
