// What decodes a client's file is in relight-import, and is not in the server: read off the names
// of the functions that each program has or asks for, linked in or loaded.
#include <gtest/gtest.h>

#include <string>

#include "tests/io/mutants.h"

namespace relight::test {
namespace {

// The class or function by which each library meets bytes. (OpenEXR's writer is in the server.)
constexpr std::string_view decoders[] = {
    "5draco",          // every class of Draco
    "meshopt_decode",  // meshoptimizer
    "stbi_",           // stb_image
    "9InputFile",      // Imf::InputFile of OpenEXR
};

TEST(ImportBoundary, RelightImportHasEveryDecoder)
{
    const std::string program = contents(RELIGHT_IMPORT_PROGRAM);
    ASSERT_FALSE(program.empty());
    for (const std::string_view name : decoders) {
        EXPECT_NE(program.find(name), std::string::npos) << name;
    }
}

TEST(ImportBoundary, TheServerHasNone)
{
    const std::string program = contents(RELIGHTD_PROGRAM);
    ASSERT_NE(program.find("relight"), std::string::npos);
    for (const std::string_view name : decoders) {
        EXPECT_EQ(program.find(name), std::string::npos) << name;
    }
    for (const std::string_view other : {"tinygltf", "vtkPNGReader", "vtkJPEGReader", "png_read",
                                         "png_create_read", "jpeg_read", "tinyexr"}) {
        EXPECT_EQ(program.find(other), std::string::npos) << other;
    }
}

}  // namespace
}  // namespace relight::test
