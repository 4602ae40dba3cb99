#include <gtest/gtest.h>

#include "core/display/display.h"
#include "tests/io/reader_checks.h"

namespace relight::test {
namespace {

const std::string data = RELIGHT_TEST_DATA;

Result<Mesh> off(std::string_view text, const ReadLimits& limits = {})
{
    return read(read_off, text, limits);
}

void expect_refused(std::string_view text, Fault fault, std::uint64_t line)
{
    const Result<Mesh> mesh = off(text);
    ASSERT_FALSE(mesh) << text;
    EXPECT_EQ(fault_code(mesh.error().fault), fault_code(fault)) << mesh.error().detail;
    EXPECT_EQ(mesh.error().line.value_or(0), line) << text << mesh.error().detail;
}

constexpr std::string_view points = "0 0 0\n1 0 0\n0 1 0\n";

TEST(OffReader, ReadsEverySampleWithTheCountsOfItsSource)  // tests/data/meshes, counted by others
{
    struct Row {
        const char* file;
        std::size_t vertices, faces;
    };
    for (const Row& row :
         {Row{"cube.off", 8, 6}, Row{"comments.off", 8, 6}, Row{"fandisk_quads.off", 766, 764}}) {
        const std::string file = contents(data + "/meshes/" + row.file);
        const Result<Mesh> mesh = off(file);
        ASSERT_TRUE(mesh) << row.file << ": " << mesh.error().detail;
        EXPECT_EQ(mesh->positions.size(), row.vertices) << row.file;
        EXPECT_EQ(mesh->faces.count(), row.faces) << row.file;
        EXPECT_EQ(mesh->faces.indices.size(), 4 * row.faces) << row.file << " is all quads";
        EXPECT_EQ(broken_promise(*mesh, file.size()), "") << row.file;
        EXPECT_EQ(mesh->format, "off");
    }
}

TEST(OffReader, PassesOverCommentsAndColoursOfFaces)
{
    const Result<Mesh> mesh = off(contents(data + "/meshes/comments.off"));
    ASSERT_TRUE(mesh);
    EXPECT_EQ(mesh->positions[1], (Point3{0.0, 1.632993, 1.154701}));  // a comment follows
    EXPECT_EQ(mesh->faces.indices[4], 7U);
    EXPECT_TRUE(mesh->colors.empty());
}

TEST(OffReader, ReadsTheSameMeshFromEveryLegalHeader)
{
    const Result<Mesh> reference = off("OFF\n3 1 0\n" + std::string(points) + "3 0 1 2\n");
    ASSERT_TRUE(reference);
    EXPECT_EQ(reference->positions, (std::vector<Point3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_EQ(reference->faces.indices, (std::vector<std::uint32_t>{0, 1, 2}));
    EXPECT_TRUE(reference->faces.offsets.empty());
    for (const char* head : {"OFF 3 1 0\n", "OFF3 1 0\n", "# who\n\nOFF # what\n# why\n\n3 1\n",
                             "\xEF\xBB\xBFOFF\r\n3 1 0\r\n", "OFF\r3 1 99\r"}) {
        const Result<Mesh> mesh =
            off(head + std::string(points) + "\n# half-way\n 3  +0 1\t2 255 0 0 # a red face");
        ASSERT_TRUE(mesh) << head << mesh.error().detail;
        EXPECT_TRUE(same(*mesh, *reference)) << head;
    }
}

TEST(OffReader, DecodesIntegerColoursFromSrgbAndTakesOthersAsLinear)
{
    const Result<Mesh> codes =
        off("COFF\n3 1 0\n0 0 0 255 128 0\n1 0 0 0 0 0\n0 1 0 10 20 30\n3 0 1 2\n");
    ASSERT_TRUE(codes) << codes.error().detail;
    ASSERT_EQ(codes->colors.size(), 3U);
    EXPECT_EQ(codes->colors[0], to_float(srgb_eotf(Rgb8{255, 128, 0})));
    EXPECT_EQ(codes->colors[2], to_float(srgb_eotf(Rgb8{10, 20, 30})));
    const Result<Mesh> alpha =
        off("COFF\n3 1 0\n0 0 0 255 128 0 255\n1 0 0 0 0 0 1\n0 1 0 10 20 30\n3 0 1 2\n");
    ASSERT_TRUE(alpha);
    EXPECT_TRUE(same(*codes, *alpha));

    const Result<Mesh> linear =
        off("COFF\n3 1 0\n0 0 0 1 0.5 0 1\n1 0 0 0 1 0 1\n0 1 0 1 1 1 1\n3 0 1 2\n");
    ASSERT_TRUE(linear);
    EXPECT_EQ(linear->colors, (std::vector<Rgbf>{{1, .5F, 0}, {0, 1, 0}, {1, 1, 1}}));
    const Result<Mesh> corners = off("COFF\n3 0 0\n0 0 0 1 0 0\n1 0 0 0 1 0\n0 1 0 1 1 1\n");
    ASSERT_TRUE(corners) << "a colour cube's corners";
    EXPECT_EQ(corners->colors[1], (Rgbf{0, 1, 0}));
}

TEST(OffReader, ReadsNormalsColoursAndTextureCoordinatesInTheirOrder)
{
    for (const char* head : {"STCNOFF", "NCSTOFF", "STNCOFF"}) {
        for (const char* alpha : {"", " .9"}) {
            const Result<Mesh> mesh =
                off(head + std::string("\n1 0 0\n1 2 3 0 0 -2 .1 .2 .3") + alpha + " .25 .75\n");
            ASSERT_TRUE(mesh) << mesh.error().detail;
            EXPECT_EQ(mesh->normals, (std::vector<Vec3>{{0, 0, -2}}));
            EXPECT_EQ(mesh->colors, (std::vector<Rgbf>{{.1F, .2F, .3F}}));
            EXPECT_EQ(mesh->uvs, (std::vector<std::array<float, 2>>{{.25F, .75F}}));
            EXPECT_EQ(mesh->faces.count(), 0U);
        }
    }
}

TEST(OffReader, ReadsPolygonsOfAnyNumberOfCorners)
{
    const Result<Mesh> mesh = off(
        "OFF\n5 3 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n3 0 1 4\n5 0 1 2 3 4 1 0 0\n4 3 2 1 0\n");
    ASSERT_TRUE(mesh) << mesh.error().detail;
    EXPECT_EQ(mesh->faces.offsets, (std::vector<std::uint32_t>{0, 3, 8, 12}));
    EXPECT_EQ(mesh->faces.indices,
              (std::vector<std::uint32_t>{0, 1, 4, 0, 1, 2, 3, 4, 3, 2, 1, 0}));
}

TEST(OffReader, RefusesBrokenFilesAtTheirLine)
{
    const auto broken = [](const char* name) { return contents(data + "/broken/" + name); };
    expect_refused(broken("a_off_huge_counts.off"), Fault::CountExceedsFile, 2);
    expect_refused(broken("assimp_OutOfMemory.off"), Fault::CountExceedsFile, 2);

    const std::string t = "OFF\n3 1 0\n" + std::string(points);
    expect_refused("", Fault::EmptyFile, 0);
    expect_refused("\n# nothing\n", Fault::MalformedHeader, 3);
    expect_refused("PLY\n", Fault::MalformedHeader, 1);
    expect_refused("4OFF\n1 0 0\n1 2 3 4\n", Fault::MalformedHeader, 1);
    expect_refused("nOFF\n3\n1 0 0\n1 2 3\n", Fault::MalformedHeader, 1);
    expect_refused("CCOFF\n1 0 0\n1 2 3 4\n", Fault::MalformedHeader, 1);
    expect_refused("OFF BINARY\n\1\2\3\4", Fault::MalformedHeader, 1);
    expect_refused("OFF", Fault::MalformedHeader, 1);
    expect_refused("OFF\n3\n", Fault::MalformedHeader, 2);
    expect_refused("OFF\n3 x 0\n", Fault::MalformedHeader, 2);
    expect_refused("OFF\n3 1 0 0\n", Fault::MalformedHeader, 2);
    expect_refused("OFF\n-3 1 0\n", Fault::MalformedHeader, 2);
    expect_refused("OFF\n99999999999999999999 1 0\n", Fault::CountExceedsFile, 2);
    expect_refused("OFF\n3 9223372036854775807 0\n" + std::string(points), Fault::CountExceedsFile,
                   2);
    expect_refused("OFF\n0 0 0\n", Fault::NoGeometry, 2);
    expect_refused(t, Fault::CountExceedsFile, 2);
    expect_refused(t + "# no more", Fault::Truncated, 6);
    expect_refused("OFF\n3 0 0\n0 0 0\n0 0 0\n# a long comment\n", Fault::Truncated, 6);
    expect_refused("OFF\n2 0 0\n0 0 0\n0 0 0 255 0 0\n", Fault::MalformedBody, 4);
    expect_refused("COFF\n2 0 0\n0 0 0 1 0 0\n0 0 0 1 2 3 4 5\n", Fault::MalformedBody, 4);
    expect_refused("COFF\n2 0 0\n0 0 0 256 0 0\n0 0 0 1 2 3\n", Fault::MalformedBody, 3);
    expect_refused("STCNOFF\n1 0 0\n1 2 3 0 0 -2 .1 .2 .3 1 .25 .75 9\n", Fault::MalformedBody, 3);
    expect_refused("OFF\n1 0 0\n0 0\n0 0\n", Fault::MalformedBody, 3);
    expect_refused("OFF\n1 0 0\n0 0 nan\n", Fault::NonFiniteCoordinate, 3);
    expect_refused("OFF\n1 0 0\n0 0 -2e15\n", Fault::CoordinateTooLarge, 3);
    expect_refused("NOFF\n1 0 0\n0 0 0 0 0 x\n", Fault::MalformedBody, 3);
    expect_refused(t + "3 0 1 3\n", Fault::IndexOutOfRange, 6);
    expect_refused(t + "3 0 1 -1\n", Fault::IndexOutOfRange, 6);
    expect_refused(t + "3 0 1 99999999999999999999\n", Fault::IndexOutOfRange, 6);
    expect_refused(t + "4 0 1 2\n", Fault::MalformedBody, 6);
    expect_refused(t + "2 0 1 \n\n", Fault::MalformedBody, 6);
    expect_refused(t + "9223372036854775807 0 1 2\n", Fault::MalformedBody, 6);
    expect_refused(t + "3 0 1 2\n3 2 1 0\n", Fault::MalformedBody, 7);
}

TEST(OffReader, SaysHowToMendAVertexOfTheWrongLength)
{
    const Result<Mesh> mesh = off("OFF\n2 0 0\n0 0 0\n0 0 0 255 0 0\n");
    ASSERT_FALSE(mesh);
    EXPECT_NE(mesh.error().detail.find("6 numbers"), std::string::npos) << mesh.error().detail;
    EXPECT_NE(mesh.error().detail.find("C before OFF"), std::string::npos) << mesh.error().detail;
}

TEST(OffReader, HoldsToItsLimitsAndStopsWhenTold)
{
    const std::string text = "OFF\n3 2 0\n" + std::string(points) + "3 0 1 2\n3 2 1 0\n";
    ASSERT_TRUE(off(text, {3, 2}));
    EXPECT_EQ(off(text, {2, 2}).error().fault, Fault::TooManyVertices);
    EXPECT_EQ(off(text, {3, 1}).error().fault, Fault::TooManyFaces);
    Progress progress;
    progress.stop();
    EXPECT_EQ(read_off(std::as_bytes(std::span(text)), {}, progress).error().fault,
              Fault::Cancelled);
}

TEST(OffReader, KeepsItsPromisesOnBrokenText)
{
    EXPECT_EQ(broken_promise_of_mutants(read_off, contents(data + "/meshes/cube.off"), 3000, 1),
              "");
    EXPECT_EQ(broken_promise_of_mutants(read_off, contents(data + "/meshes/comments.off"), 3000, 2),
              "");
    const std::string full =
        "STCNOFF\n3 1 0\n1 2 3 0 0 -2 .1 .2 .3 .25 .75\n1 2 4 0 0 1 1 2 3 4 .25 .75\n1 0 3 0 0 -2 "
        ".1 .2 .3 .25 .75\n3 0 1 2\n";
    EXPECT_EQ(broken_promise_of_mutants(read_off, full, 6000, 3), "");
}

}  // namespace
}  // namespace relight::test
