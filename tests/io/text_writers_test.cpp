#include <assimp/mesh.h>
#include <assimp/scene.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstring>
#include <map>

#include "tests/io/full_mesh.h"
#include "tests/io/reader_checks.h"
#include "tests/written.h"

namespace relight {
namespace {

using test::floats;
using test::full_mesh;

Mesh read_back(test::Reader reader, const std::string& text)
{
    Result<Mesh> mesh = test::read(reader, text);
    EXPECT_TRUE(mesh) << mesh.error().detail;
    return mesh ? std::move(*mesh) : Mesh{};
}

void expect_same(const Mesh& a, const Mesh& b, const std::string& what)
{
    if (b.double_positions) { EXPECT_EQ(a.positions, b.positions) << what; }
    EXPECT_EQ(floats(a.positions), floats(b.positions)) << what;
    EXPECT_EQ(a.double_positions, b.double_positions) << what;
    EXPECT_EQ(a.faces.indices, b.faces.indices) << what;
    EXPECT_EQ(a.faces.offsets, b.faces.offsets) << what;
    EXPECT_EQ(floats(a.normals), floats(b.normals)) << what;
    EXPECT_EQ(a.colors, b.colors) << what;
    EXPECT_EQ(a.uvs, b.uvs) << what;
    EXPECT_EQ(a.corner_uvs, b.corner_uvs) << what;
    EXPECT_EQ(a.materials, b.materials) << what;
    EXPECT_EQ(a.face_materials, b.face_materials) << what;
}

/// Moves the mesh to where floats are too coarse for it.
void make_double(Mesh& mesh)
{
    for (Point3& p : mesh.positions) {
        p = {1e9 + std::fmod(p.x, 8.0), std::fmod(p.y, 8.0), std::fmod(p.z, 8.0)};
    }
    mesh.double_positions = true;
}

/// Every mixture of what a mesh may have; `corners`: OBJ's uvs by corner, and materials.
std::vector<std::pair<std::string, Mesh>> mixtures(bool corners)
{
    std::vector<std::pair<std::string, Mesh>> out;
    for (unsigned bits = 0; bits < 128; ++bits) {
        const auto bit = [&](unsigned k) { return (bits >> k & 1U) != 0; };
        if (!corners && (bit(5) || bit(6))) { continue; }
        Mesh mesh = full_mesh(300);
        if (!bit(0)) { mesh.normals.clear(); }
        if (!bit(1)) { mesh.uvs.clear(); }
        if (!bit(2)) { mesh.colors.clear(); }
        if (!bit(3)) { test::drop_polygons(mesh); }
        if (bit(4)) { make_double(mesh); }
        if (bit(5)) {
            mesh.uvs.clear();
            for (std::size_t c = 0; c < mesh.faces.indices.size(); ++c) {
                mesh.corner_uvs.push_back({0.1F * static_cast<float>(c % 7), -0.25F});
            }
        }
        if (bit(6)) {
            mesh.materials = {"wall", "a # b/c", "Straße"};
            for (std::size_t f = 0; f < mesh.faces.count(); ++f) {
                mesh.face_materials.push_back(f < 3 ? 0 : f % 5 < 4 ? 1 : 2);
            }
        }
        out.emplace_back("mixture " + std::to_string(bits), std::move(mesh));
    }
    return out;
}

std::vector<Rgb8> all_codes(std::size_t count)
{
    std::vector<Rgb8> codes;
    for (std::size_t i = 0; i < count; ++i) {
        codes.push_back({static_cast<unsigned char>(i), static_cast<unsigned char>(255 - i % 256),
                         static_cast<unsigned char>(7 * i)});
    }
    return codes;
}

TEST(WriteObj, WhatIsWrittenReadsBackTheSame)
{
    for (const auto& [what, mesh] : mixtures(true)) {
        expect_same(read_back(read_obj, write_obj({mesh, {}, {}, {}, {}})), mesh, what);
    }
}

TEST(WriteOff, WhatIsWrittenReadsBackTheSame)
{
    for (const auto& [what, mesh] : mixtures(false)) {
        expect_same(read_back(read_off, write_off({mesh, {}, {}, {}, {}})), mesh, what);
    }
}

TEST(WriteObj, ACloudKeepsItsPlacesNormalsAndColours)
{
    Mesh cloud = full_mesh(50);
    cloud.faces = {};
    cloud.uvs.clear();
    expect_same(read_back(read_obj, write_obj({cloud, {}, {}, {}, {}})), cloud, "obj");
    expect_same(read_back(read_off, write_off({cloud, {}, {}, {}, {}})), cloud, "off");
}

TEST(WriteObj, LinesSayNoDigitTooMany)
{
    Mesh mesh;
    mesh.positions = {{0.1F, 0.25, -3}, {1e-7F, 0, 1e6}, {1.0F / 3.0F, 2, 3}};
    mesh.normals = {{0, 0, 1}, {0, 0.6F, 0.8F}, {1, 0, 0}};
    mesh.corner_uvs = {{0.5F, 0.75F}, {0, 1}, {1, 0}, {0.5F, 0.75F}, {1, 0}, {0.1F, 1}};
    mesh.faces.indices = {0, 1, 2, 0, 2, 1};
    mesh.materials = {"a", "b"};
    mesh.face_materials = {1, 0};
    const std::vector<Rgb8> color{{0, 255, 51}, {102, 1, 0}, {0, 0, 0}};
    EXPECT_EQ(write_obj({mesh, {}, color, {}, {"exposure_ev 0"}}),
              "# exposure_ev 0\n# v x y z r g b: sRGB, code / 255\n"
              "v 0.1 0.25 -3 0 1 0.2\nv 1e-07 0 1e+06 0.4 0.003921569 0\n"
              "v 0.33333334 2 3 0 0 0\n"
              "vt 0.5 0.75\nvt 0 1\nvt 1 0\nvt 0.1 1\n"
              "vn 0 0 1\nvn 0 0.6 0.8\nvn 1 0 0\n"
              "usemtl b\nf 1/1/1 2/2/2 3/3/3\nusemtl a\nf 1/1/1 3/3/3 2/4/2\n");
    mesh.corner_uvs.clear();
    EXPECT_NE(write_obj({mesh, {}, {}, {}, {}}).find("f 1//1 2//2 3//3\n"), std::string::npos);
    mesh.normals.clear();
    EXPECT_NE(write_obj({mesh, {}, {}, {}, {}}).find("f 1 2 3\n"), std::string::npos);
    mesh.uvs = {{0, 0}, {0, 1}, {1, 0}};
    EXPECT_NE(write_obj({mesh, {}, {}, {}, {}}).find("f 1/1 2/2 3/3\n"), std::string::npos);
}

TEST(WriteOff, LinesSayNoDigitTooMany)
{
    Mesh mesh;
    mesh.positions = {{0.1F, 0.25, -3}, {1e-7F, 0, 1e6}, {1.0F / 3.0F, 2, 3}};
    mesh.uvs = {{0.5F, 0.75F}, {0, 1}, {1, 0}};
    mesh.faces.indices = {0, 1, 2};
    const std::vector<Rgb8> color{{0, 255, 51}, {102, 1, 0}, {0, 0, 0}};
    EXPECT_EQ(write_off({mesh, {}, color, {}, {"exposure_ev 0"}}),
              "STCOFF\n# exposure_ev 0\n3 1 0\n0.1 0.25 -3 0 255 51 255 0.5 0.75\n"
              "1e-07 0 1e+06 102 1 0 255 0 1\n0.33333334 2 3 0 0 0 255 1 0\n3 0 1 2\n");
}

TEST(WriteObj, EveryColourCodeReadsBackAsItsShareOf255)
{
    const Mesh mesh = full_mesh(256);
    const std::vector<Rgb8> color = all_codes(256);
    const Mesh back = read_back(read_obj, write_obj({mesh, {}, color, {}, {}}));
    ASSERT_EQ(back.colors.size(), 256U);
    for (std::size_t i = 0; i < 256; ++i) {
        for (std::size_t band = 0; band < 3; ++band) {
            EXPECT_EQ(back.colors[i][band], static_cast<float>(color[i][band]) / 255.0F);
        }
    }
}

TEST(WriteOff, EveryColourReadsBackAsItself)
{
    const Mesh mesh = full_mesh(256);
    std::vector<Rgb8> color = all_codes(256);
    const auto expect_color = [&] {
        const Mesh back = read_back(read_off, write_off({mesh, {}, color, {}, {}}));
        ASSERT_EQ(back.colors.size(), 256U);
        for (std::size_t i = 0; i < 256; ++i) {
            EXPECT_EQ(back.colors[i], to_float(srgb_eotf(color[i])));
        }
    };
    expect_color();
    color.assign(256, {0, 1, 0});  // as integers, these would be a full green
    expect_color();
    color.assign(256, {0, 0, 0});
    expect_color();
}

TEST(WriteOff, LinearColoursAreNotTakenForCodes)
{
    Mesh mesh = full_mesh(20);
    mesh.colors.assign(20, {2.0F, 5.0F, 0.0F});  // whole numbers
    expect_same(read_back(read_off, write_off({mesh, {}, {}, {}, {}})), mesh, "whole");
    mesh.colors.assign(20, {1e20F, 1e-20F, 300.25F});
    mesh.colors[3] = {4e14F, 1e-20F, 300.25F};
    mesh.colors.assign(20, {4e14F, 1e-20F, 300.25F});
    expect_same(read_back(read_off, write_off({mesh, {}, {}, {}, {}})), mesh, "wide");
    expect_same(read_back(read_obj, write_obj({mesh, {}, {}, {}, {}})), mesh, "obj");
}

TEST(WriteText, AskedForNormalsReplaceTheFiledOnes)
{
    const Mesh mesh = full_mesh(40);
    std::vector<Dir3> normals(40, normalize({1, 2, -2}));
    normals[3] = {};  // a vertex without one
    for (const Mesh& back : {read_back(read_obj, write_obj({mesh, normals, {}, {}, {}})),
                             read_back(read_off, write_off({mesh, normals, {}, {}, {}}))}) {
        ASSERT_EQ(back.normals.size(), 40U);
        for (std::size_t i = 0; i < 40; ++i) {
            EXPECT_NEAR(length(back.normals[i] - normals[i]), 0.0, 1e-7);
        }
    }
}

TEST(WriteText, TextureCoordinatesOfGltfAreTurnedUpOthersKept)
{
    Mesh mesh = full_mesh(20);
    for (const bool corners : {false, true}) {
        if (corners) { mesh.corner_uvs.resize(mesh.faces.indices.size(), {0.25F, 0.125F}); }
        mesh.corner_uvs.resize(corners ? mesh.faces.indices.size() : 0);
        for (std::size_t c = 0; c < mesh.corner_uvs.size(); ++c) {
            mesh.corner_uvs[c] = {0.25F, c % 2 == 0 ? 0.125F : 0.75F};
        }
        const auto written = [&](const char* format) {
            mesh.format = format;
            const LitMesh lit{mesh, {}, {}, {}, {}};
            return std::array{read_back(read_obj, write_obj(lit)),
                              read_back(read_ply, write_ply(lit, PlyEncoding::Ascii)),
                              read_back(read_ply, write_ply(lit, PlyEncoding::BinaryLittleEndian))};
        };
        const auto kept = written("obj"), turned = written("glb");
        for (std::size_t k = 0; k < kept.size(); ++k) {
            const auto& before = corners ? kept[k].corner_uvs : kept[k].uvs;
            const auto& after = corners ? turned[k].corner_uvs : turned[k].uvs;
            ASSERT_EQ(before, corners ? mesh.corner_uvs : mesh.uvs);
            ASSERT_EQ(after.size(), before.size());
            for (std::size_t i = 0; i < before.size(); ++i) {
                EXPECT_EQ(after[i], (Uv{before[i][0], 1.0F - before[i][1]}));
            }
        }
    }
    mesh.corner_uvs.clear();
    const Mesh off = read_back(read_off, write_off({mesh, {}, {}, {}, {}}));
    EXPECT_EQ(off.uvs[5], (Uv{mesh.uvs[5][0], 1.0F - mesh.uvs[5][1]}));
}

TEST(WriteObj, EveryMaterialKeepsANameOfItsOwnOnOneLine)
{
    Mesh mesh = full_mesh(10);
    mesh.materials = {"wall", "wall", "wall_1", " a\nv 0 0 0\r", "", "door\\", "wall"};
    for (std::size_t f = 0; f < mesh.faces.count(); ++f) {
        mesh.face_materials.push_back(static_cast<std::uint32_t>(f % mesh.materials.size()));
    }
    const Mesh back = read_back(read_obj, write_obj({mesh, {}, {}, {}, {}}));
    EXPECT_EQ(back.positions.size(), 10U);
    EXPECT_EQ(back.face_materials, mesh.face_materials);
    const std::vector<std::string> names{"wall", "wall_1", "wall_1_2", "a v 0 0 0",
                                         "",     "door_",  "wall_6"};
    EXPECT_EQ(back.materials, names);
}

TEST(WriteText, NoTextOfAClientGetsOutOfItsComment)
{
    const Mesh mesh = full_mesh(10);
    const std::string comment = "units\nv 9 9 9\r\n3 0 0 0\f\\";
    const LitMesh lit{mesh, {}, {}, {}, {comment, "next"}};
    expect_same(read_back(read_obj, write_obj(lit)), mesh, "obj");
    expect_same(read_back(read_off, write_off(lit)), mesh, "off");
    EXPECT_NE(write_obj(lit).find("# units v 9 9 9  3 0 0 0 \\ \n# next\n"), std::string::npos);
}

TEST(WriteText, AnAbsentPointIsNanWhereReadersTakeItElseAPlaceholder)
{
    Mesh cloud = full_mesh(20);
    cloud.faces = {};
    cloud.uvs.clear();
    cloud.absent = {3, 7, 19};
    for (const std::uint32_t i : cloud.absent) { cloud.positions[i] = cloud.positions[0]; }
    const LitMesh lit{cloud, {}, {}, {}, {}};
    const std::string obj = write_obj(lit), off = write_off(lit);
    expect_same(read_back(read_obj, obj), cloud, "obj");
    expect_same(read_back(read_off, off), cloud, "off");
    EXPECT_NE(obj.find("# 3 points are absent"), std::string::npos);
    EXPECT_NE(off.find("# 3 points are absent"), std::string::npos);
    const std::string npz = write_npz(lit);
    const std::size_t data = npz.find('\n', npz.find("positions.npy")) + 1;
    ASSERT_LE(data + 20 * sizeof(Point3), npz.size());
    for (std::uint32_t i = 0; i < 20; ++i) {
        Point3 p;
        std::memcpy(&p, npz.data() + data + i * sizeof(Point3), sizeof(Point3));
        const bool absent =
            std::find(cloud.absent.begin(), cloud.absent.end(), i) != cloud.absent.end();
        EXPECT_TRUE(absent ? std::isnan(p.x) && std::isnan(p.y) && std::isnan(p.z)
                           : p == cloud.positions[i]);
    }
    for (const bool twice : {false, true}) {
        cloud.double_positions = twice;
        for (const PlyEncoding encoding : {PlyEncoding::Ascii, PlyEncoding::BinaryLittleEndian}) {
            const Mesh back = read_back(read_ply, write_ply(lit, encoding));
            EXPECT_EQ(back.absent, cloud.absent);
            EXPECT_EQ(floats(back.positions), floats(cloud.positions));
        }
    }
}

/// What assimp finds: the colour of each place, and how many faces have how many corners.
struct Found {
    std::map<std::array<float, 3>, Rgbf> colors;
    std::map<unsigned, std::size_t> faces;
};

Found read_by_assimp(const std::string& text, const char* format)
{
    Assimp::Importer importer;
    const aiScene* scene = importer.ReadFileFromMemory(text.data(), text.size(), 0, format);
    EXPECT_NE(scene, nullptr) << importer.GetErrorString();
    Found found;
    for (unsigned m = 0; scene != nullptr && m < scene->mNumMeshes; ++m) {
        const aiMesh& mesh = *scene->mMeshes[m];
        for (unsigned f = 0; f < mesh.mNumFaces; ++f) { ++found.faces[mesh.mFaces[f].mNumIndices]; }
        for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
            const aiVector3D p = mesh.mVertices[v];
            const aiColor4D c =
                mesh.HasVertexColors(0) ? mesh.mColors[0][v] : aiColor4D(-1, -1, -1, -1);
            found.colors[{p.x, p.y, p.z}] = {c.r, c.g, c.b};
        }
    }
    return found;
}

TEST(WriteText, AnotherReaderFindsTheSamePlacesFacesAndColours)
{
    Mesh mesh = full_mesh(256);
    mesh.materials = {"one", "two"};
    for (std::size_t f = 0; f < mesh.faces.count(); ++f) {
        mesh.face_materials.push_back(f < 100 ? 0 : 1);
    }
    const std::vector<Rgb8> color = all_codes(256);
    const LitMesh lit{mesh, {}, color, {}, {"a comment"}};
    std::map<std::array<float, 3>, Rgbf> expected;
    for (std::size_t i = 0; i < 256; ++i) {
        Rgbf& share =
            expected[to_float(Rgb{mesh.positions[i].x, mesh.positions[i].y, mesh.positions[i].z})];
        for (std::size_t band = 0; band < 3; ++band) {
            share[band] = static_cast<float>(color[i][band]) / 255.0F;
        }
    }
    const std::map<unsigned, std::size_t> faces{{3, 254}, {4, 1}, {5, 1}};
    const Found obj = read_by_assimp(write_obj(lit), "obj");
    mesh.normals.clear();  // in OFF, it takes a normal's z for the red of a colour
    const Found off = read_by_assimp(write_off(lit), "off");
    for (const Found* found : {&obj, &off}) {
        EXPECT_EQ(found->faces, faces);
        ASSERT_EQ(found->colors.size(), expected.size());
        const float one = found == &obj ? 1.0F : 255.0F;  // OFF's codes are left as they are
        auto at = found->colors.begin();
        for (auto e = expected.begin(); e != expected.end(); ++at, ++e) {
            for (std::size_t band = 0; band < 3; ++band) {
                EXPECT_NEAR(at->first[band], e->first[band], 1e-5 * std::abs(e->first[band]));
                EXPECT_NEAR(at->second[band] / one, e->second[band], 1e-5);
            }
        }
    }
}

}  // namespace
}  // namespace relight
