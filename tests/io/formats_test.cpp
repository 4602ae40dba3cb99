#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>

#include "core/geometry/precision.h"
#include "tests/io/reader_checks.h"

namespace relight {
namespace {

std::optional<MeshFormat> of_bytes(std::string_view text)
{
    return mesh_format_of_bytes(std::as_bytes(std::span(text)));
}

TEST(MeshFormat, IsFoundByItsNameAndGivesItBack)
{
    for (const MeshFormat format :
         {MeshFormat::Ply, MeshFormat::Obj, MeshFormat::Off, MeshFormat::Stl, MeshFormat::Xyz,
          MeshFormat::Pts, MeshFormat::Pcd, MeshFormat::Las}) {
        EXPECT_EQ(mesh_format_named(name_of(format)), format);
    }
    EXPECT_EQ(mesh_format_named("txt"), MeshFormat::Xyz);
    EXPECT_EQ(mesh_format_named("laz"), MeshFormat::Las);
    EXPECT_FALSE(mesh_format_named("PLY"));
    EXPECT_FALSE(mesh_format_named("glb"));
    EXPECT_FALSE(mesh_format_named(""));
}

TEST(MeshFormat, MediaTypesIgnoreCaseAndParameters)
{
    EXPECT_EQ(mesh_format_of_media("model/stl"), MeshFormat::Stl);
    EXPECT_EQ(mesh_format_of_media("Model/OBJ; charset=utf-8"), MeshFormat::Obj);
    EXPECT_EQ(mesh_format_of_media("application/x-ply"), MeshFormat::Ply);
    EXPECT_EQ(mesh_format_of_media("model/off"), MeshFormat::Off);
    EXPECT_EQ(mesh_format_of_media("application/vnd.las"), MeshFormat::Las);
    EXPECT_EQ(mesh_format_of_media("application/vnd.laszip"), MeshFormat::Las);
    EXPECT_EQ(mesh_format_of_media("application/x-pcd"), MeshFormat::Pcd);
    EXPECT_EQ(mesh_format_of_media("application/x-pts"), MeshFormat::Pts);
    EXPECT_EQ(mesh_format_of_media("chemical/x-xyz"), MeshFormat::Xyz);
    EXPECT_FALSE(mesh_format_of_media("text/plain")) << "may be any of five";
    EXPECT_FALSE(mesh_format_of_media("application/octet-stream"));
    EXPECT_FALSE(mesh_format_of_media("model/stlx"));
}

TEST(MeshFormat, EverySampleIsKnownByItsBytes)
{
    int files = 0;
    for (const char* folder : {"/meshes", "/clouds"}) {
        for (const auto& entry :
             std::filesystem::directory_iterator(std::string(RELIGHT_TEST_DATA) + folder)) {
            std::string name = entry.path().extension().string().substr(1);
            if (name == "mtl") { continue; }
            if (name == "STL") { name = "stl"; }
            if (name == "laz") { name = "las"; }  // whose reader says what to do
            const auto format = of_bytes(test::contents(entry.path()));
            ASSERT_TRUE(format) << entry.path();
            EXPECT_EQ(name_of(*format), name) << entry.path();
            ++files;
        }
    }
    EXPECT_GT(files, 30);
}

TEST(MeshFormat, BinaryStlIsKnownByItsLengthEvenIfItSaysSolid)
{
    std::string file(84 + 50, '\0');
    std::memcpy(file.data(), "solid", 5);
    file[80] = 1;
    EXPECT_EQ(of_bytes(file), MeshFormat::Stl);
    file = "ply me a solid" + file.substr(14);
    EXPECT_EQ(of_bytes(file.substr(0, 3) + "X" + file.substr(4)), MeshFormat::Stl);
    file.pop_back();
    EXPECT_FALSE(of_bytes("x" + file));
}

TEST(MeshFormat, RowsOfNumbersAreKnownByTheirFirstLines)
{
    for (const char* text :
         {"1 2 3", "# by hand\n\n// of mine\n-1.5,2e3,.3,9\n", "1;2;3;4;5;6\n", "x y z\n1 2 3\n",
          "\"X\",\"Y\",\"Z\",\"Time\"\n1,2,3,4\n", "\xEF\xBB\xBF 1 2 3\n"}) {
        EXPECT_EQ(of_bytes(text), MeshFormat::Xyz) << text;
    }
    for (const char* text : {"2\n1 2 3\n1 2 3\n", "\n 1\r\n1 2 3 4 5 6 7\r\n", "2\n1 2 3 # cut"}) {
        EXPECT_EQ(of_bytes(text), MeshFormat::Pts) << text;
    }
    for (const char* text :
         {"1", "1\n", "1 2\n3 4\n", "1\n2\n3\n", "1.5\n1 2 3\n", "3\nC 0 0 0\n", "x y z\n",
          "x y z\na b c\n", "x y\n1 2 3\n", "1 2 three\n", "1 nan 3\n"}) {
        EXPECT_FALSE(of_bytes(text)) << text;
    }
    EXPECT_EQ(of_bytes("# .PCD v0.7\n1 2 3\n"), MeshFormat::Pcd);
    EXPECT_EQ(of_bytes("# a comment\nVERSION 0.7\n"), MeshFormat::Pcd);
    EXPECT_EQ(of_bytes("LASF"), MeshFormat::Las);
}

TEST(MeshFormat, NothingKnownIsNothing)
{
    for (const char* text :
         {"", "\n", "#", "# only a comment\n", "glTF", "{\"asset\":{}}", "plyx\n", "hello"}) {
        EXPECT_FALSE(of_bytes(text)) << text;
    }
}

TEST(ReadMesh, ReadsWithTheReaderOfTheFormat)
{
    for (const char* file : {"meshes/cube_quads.ply", "meshes/cube.off", "meshes/suzanne.obj",
                             "meshes/soup.stl", "clouds/points_agisoft.xyz", "clouds/test.pts",
                             "clouds/bun0.pcd", "clouds/test1_4.las"}) {
        const std::string text = test::contents(std::string(RELIGHT_TEST_DATA) + "/" + file);
        Progress progress;
        const auto format = of_bytes(text);
        ASSERT_TRUE(format);
        const Result<Mesh> mesh = read_mesh(*format, std::as_bytes(std::span(text)), {}, progress);
        ASSERT_TRUE(mesh) << file << ": " << mesh.error().detail;
        EXPECT_EQ(mesh->format, name_of(*format));
    }
}

// The step of a float between 2^22 and 2^23 is 1/2, so a move of 1/4; 1e-7 of 2.5e6 is just that.
TEST(FloatLoses, TextOnlyWhenACoordinateMovesByTenMillionthOfTheSize)
{
    const auto loses = [](double size) {
        const std::vector<Point3> cloud = {{4194304.25, 0, 0}, {4194304.25 - size, 0, 0}};
        return float_loses_text(cloud);
    };
    EXPECT_TRUE(loses(2.49e6));
    EXPECT_FALSE(loses(2.51e6));
}

TEST(FloatLoses, AnythingThatIsNotExactlyAFloat)
{
    EXPECT_FALSE(float_loses(std::vector<Point3>{{0.5, -3, 1e10}}));
    EXPECT_TRUE(float_loses(std::vector<Point3>{{0.5, -3, 0.1}}));
    EXPECT_FALSE(float_loses({}));
    EXPECT_FALSE(float_loses_text({}));
}

}  // namespace
}  // namespace relight
