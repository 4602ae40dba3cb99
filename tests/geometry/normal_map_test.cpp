// Tangent-space normal maps on grids in the plane z = 0 with known texture coordinates.
#include "core/geometry/normal_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/textures.h"

namespace relight {
namespace {

using test::Code;
using test::plain;

constexpr double degree = std::numbers::pi / 180.0;

Surface prepared(const Mesh& mesh)
{
    Progress progress;
    return prepare(mesh, 1, progress);
}

/// The code of a direction, and the direction that it stands for once rounded.
Code code_of(Vec3 n)
{
    const auto code = [](double x) {
        return static_cast<std::uint8_t>(std::lround(255.0 * 0.5 * (x + 1.0)));
    };
    return {code(n.x), code(n.y), code(n.z), 255};
}
Dir3 told_by(Code code)
{
    return normalize({code[0] / 127.5 - 1.0, code[1] / 127.5 - 1.0, code[2] / 127.5 - 1.0});
}

/// A picture on a flat grid: (0, 0) is its upper left corner, so that its up is +y.
Mesh pictured(int n, Code code, double mirror_u = 1.0)
{
    Mesh mesh = test::grid(n);
    for (const Point3 p : mesh.positions) {
        mesh.uvs.push_back({static_cast<float>(mirror_u * p.x), static_cast<float>(-p.y)});
    }
    mesh.materials = {"mapped"};
    mesh.face_materials.assign(mesh.faces.count(), 0);
    mesh.textures = {plain(code)};
    mesh.maps.resize(1);
    mesh.maps[0].normal = TextureMap{};
    return mesh;
}

double distance(Vec3 a, Vec3 b)
{
    return length(a - b);
}
double angle(Vec3 a, Vec3 b)
{
    return std::atan2(length(cross(a, b)), dot(a, b));
}

/// 30 degrees toward the picture's right, 20 more toward its top.
const Code tilted = code_of({0.47, 0.34, 0.81});

TEST(NormalMap, ATiltAlongThePicturesAxesIsTheSameTiltOfTheSurface)
{
    const Surface surface = prepared(pictured(3, tilted));
    ASSERT_EQ(surface.smooth_normals.size(), 16U);
    for (std::size_t v = 0; v < 16; ++v) {
        EXPECT_NEAR(distance(surface.normals[v], told_by(tilted)), 0.0, 1e-7);
        EXPECT_EQ(Vec3(surface.smooth_normals[v]), (Vec3{0, 0, 1}));
        EXPECT_EQ(surface.tangents[v], (std::array<float, 4>{1, 0, 0, 1}));
    }
}

TEST(NormalMap, TurnsWithItsMesh)
{
    const Frame turn = frame_around(normalize({0.3, -0.5, 0.7}));
    const Surface surface = prepared(test::moved(pictured(3, tilted), turn, 2.0, {1, 2, 3}));
    for (const Dir3 n : surface.normals) {
        EXPECT_NEAR(distance(n, turn.to_world(told_by(tilted))), 0.0, 1e-6);
    }
}

TEST(NormalMap, OfAMirroredPictureTiltsTheMirroredWay)
{
    const Surface surface = prepared(pictured(3, tilted, -1.0));
    const Dir3 told = told_by(tilted);
    for (std::size_t v = 0; v < 16; ++v) {  // right is -x now, up still +y
        EXPECT_NEAR(distance(surface.normals[v], Vec3{-told.x(), told.y(), told.z()}), 0.0, 1e-7);
        EXPECT_EQ(surface.tangents[v][3], -1.0F);
    }
}

TEST(NormalMap, SeenFromBehindItsFacesAPictureIsMirrored)
{
    Mesh mesh = pictured(3, tilted);
    mesh.normals.assign(16, {0, 0, -1});  // as filed, against the winding
    const Surface surface = prepared(mesh);
    const Dir3 told = told_by(tilted);
    for (std::size_t v = 0; v < 16; ++v) {  // right is +x, up +y, and toward the viewer -z
        EXPECT_EQ(surface.tangents[v][3], -1.0F);
        EXPECT_NEAR(distance(surface.normals[v], Vec3{told.x(), told.y(), -told.z()}), 0.0, 1e-7);
    }
}

TEST(NormalMap, WithoutStrengthLeavesTheSmoothNormals)
{
    Mesh mesh = pictured(3, tilted);
    mesh.maps[0].normal_scale = 0.0F;
    for (const Dir3 n : prepared(mesh).normals) { EXPECT_EQ(Vec3(n), (Vec3{0, 0, 1})); }
}

TEST(NormalMap, ScaleMultipliesTheTangentOfTheTilt)
{
    for (const double scale : {0.25, 1.0, 3.0, -1.0}) {
        Mesh mesh = pictured(1, tilted);
        mesh.maps[0].normal_scale = static_cast<float>(scale);
        const Dir3 told = told_by(tilted);
        const Dir3 n = prepared(mesh).normals[0];
        EXPECT_NEAR(n.x() / n.z(), scale * told.x() / told.z(), 1e-6);
        EXPECT_NEAR(n.y() / n.z(), scale * told.y() / told.z(), 1e-6);
    }
}

TEST(NormalMap, TheFlatCodeBendsByLessThanAThirdOfADegree)
{
    // No code is the middle of 0 .. 255: 128 says 1/255.
    const Dir3 n = prepared(pictured(1, {128, 128, 255, 255})).normals[0];
    EXPECT_GT(angle(n, {0, 0, 1}), 0.3 * degree);
    EXPECT_LT(angle(n, {0, 0, 1}), 0.33 * degree);
}

TEST(NormalMap, NeverBendsBelowTheHorizon)
{
    for (const Code code : {Code{255, 128, 0, 255}, Code{0, 0, 0, 255}, Code{255, 255, 127, 255},
                            Code{128, 127, 0, 255}}) {
        const Dir3 n = prepared(pictured(1, code)).normals[0];
        EXPECT_NEAR(length(n), 1.0, 1e-12);
        EXPECT_GT(n.z(), 0.009);
    }
}

TEST(NormalMap, PointingNowhereLeavesTheSmoothNormal)
{
    Mesh mesh = pictured(1, {});
    const Dir3 up = normalize({0, 0, 1});
    // Half way between the codes 127 and 128, all channels are 0.
    mesh.textures = {{2, 1, {{127, 127, 127, 255}, {128, 128, 128, 255}}}};
    EXPECT_EQ(bent_normal(up, {1, 0, 0}, 1.0, mesh.textures[0], mesh.maps[0], {0.5F, 0.5F}), up);
    // And so does a texture on a surface that has no tangent.
    mesh.textures = {plain(tilted)};
    EXPECT_EQ(bent_normal(up, {}, 1.0, mesh.textures[0], mesh.maps[0], {0.5F, 0.5F}), up);
    EXPECT_EQ(bent_normal(up, {0, 0, 2}, 1.0, mesh.textures[0], mesh.maps[0], {0.5F, 0.5F}), up);
    mesh.uvs.assign(4, {0.5F, 0.5F});
    for (const Dir3 n : prepared(mesh).normals) { EXPECT_EQ(n, up); }
}

TEST(NormalMap, AVertexHasTheMapOfTheFirstFaceThatUsesIt)
{
    Mesh mesh = pictured(2, tilted);
    mesh.materials = {"mapped", "smooth"};
    mesh.maps.resize(2);
    for (std::size_t f = 0; f < 4; ++f) { mesh.face_materials[f] = 1; }  // the lower two squares
    mesh.positions.push_back({0, 0, 5});                                 // of no face
    mesh.uvs.push_back({0, 0});
    mesh.normals.assign(10, {0, 0, 1});
    const Surface surface = prepared(mesh);
    EXPECT_EQ(surface.vertex_groups[9], no_group);
    for (std::size_t v = 0; v < 10; ++v) {
        const bool bent = v >= 6 && v < 9;
        EXPECT_EQ(angle(surface.normals[v], {0, 0, 1}) > 1.0 * degree, bent) << v;
    }
}

TEST(NormalMap, ReadsTheSetOfCoordinatesThatItNames)
{
    Mesh mesh = pictured(2, {});
    mesh.textures = {{2, 1, {tilted, {128, 128, 255, 255}}}};
    mesh.maps[0].normal->nearest = true;
    mesh.maps[0].normal->uv_set = 1;
    const std::vector<Uv> set_0 = mesh.uvs;
    for (const Point3 p : mesh.positions) {  // its right is +y, its up -x; all in the left texel
        mesh.uvs_1.push_back({static_cast<float>(0.1 * p.y + 0.25), static_cast<float>(p.x)});
    }
    for (const bool both : {true, false}) {
        mesh.uvs = both ? set_0 : std::vector<Uv>();
        const Surface surface = prepared(mesh);
        const Dir3 told = told_by(tilted);
        for (std::size_t v = 0; v < 9; ++v) {
            EXPECT_NEAR(distance(surface.normals[v], Vec3{-told.y(), told.x(), told.z()}), 0.0,
                        1e-6);
        }
    }
}

TEST(NormalMap, MeshesWithoutNormalMapsKeepTheirNormalsAndNoSecondOnes)
{
    Mesh mesh = pictured(2, tilted);
    mesh.maps[0].normal.reset();
    mesh.maps[0].base_color = TextureMap{};
    const Surface surface = prepared(mesh);
    EXPECT_TRUE(surface.smooth_normals.empty());
    for (const Dir3 n : surface.normals) { EXPECT_EQ(Vec3(n), (Vec3{0, 0, 1})); }
}

TEST(FiledTangents, AreUsedWhereTheFileHasOneAndElseThoseOfTheCoordinates)
{
    Mesh mesh = pictured(1, tilted);
    mesh.tangents = {{0, 3, 0.5F, -1}, {}, {0, 0, 1, -1}, {0.6F, -0.8F, 0, 1}};
    const Surface surface = prepared(mesh);
    EXPECT_EQ(surface.tangents[0], (std::array<float, 4>{0, 1, 0, -1}));  // made perpendicular
    EXPECT_EQ(surface.tangents[1], (std::array<float, 4>{1, 0, 0, 1}));   // zero: none
    EXPECT_EQ(surface.tangents[2], (std::array<float, 4>{1, 0, 0, 1}));   // along the normal
    EXPECT_FLOAT_EQ(surface.tangents[3][0], 0.6F);
    EXPECT_FLOAT_EQ(surface.tangents[3][1], -0.8F);
    // n' = x T + y B + z N with B = -N x T = x axis
    const Dir3 told = told_by(tilted);
    EXPECT_NEAR(distance(surface.normals[0], Vec3{told.y(), told.x(), told.z()}), 0.0, 1e-6);
    for (std::size_t v = 0; v < 4; ++v) {  // the shading frame is right-handed all the same
        const Frame frame = shading_frame(surface, v);
        EXPECT_NEAR(distance(cross(frame.x, frame.y), frame.n), 0.0, 1e-12);
    }
}

TEST(FiledTangents, NeedNoTextureCoordinates)
{
    Mesh mesh = test::grid(1);
    mesh.tangents.assign(4, {0, 1, 0, 1});
    for (const auto& tangent : prepared(mesh).tangents) {
        EXPECT_EQ(tangent, (std::array<float, 4>{0, 1, 0, 1}));
    }
}

}  // namespace
}  // namespace relight
