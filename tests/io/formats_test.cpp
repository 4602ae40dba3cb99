#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>

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
         {MeshFormat::Ply, MeshFormat::Obj, MeshFormat::Off, MeshFormat::Stl}) {
        EXPECT_EQ(mesh_format_named(name_of(format)), format);
    }
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

TEST(MeshFormat, NothingKnownIsNothing)
{
    for (const char* text :
         {"", "\n", "#", "# only a comment\n", "glTF", "{\"asset\":{}}", "plyx\n", "hello"}) {
        EXPECT_FALSE(of_bytes(text)) << text;
    }
}

TEST(ReadMesh, ReadsWithTheReaderOfTheFormat)
{
    for (const char* file : {"cube_quads.ply", "cube.off", "suzanne.obj", "soup.stl"}) {
        const std::string text = test::contents(std::string(RELIGHT_TEST_DATA) + "/meshes/" + file);
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
