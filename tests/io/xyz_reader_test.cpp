#include "core/display/display.h"
#include "tests/io/cloud_checks.h"

namespace relight::test {
namespace {

Result<Mesh> xyz(std::string_view text)
{
    return read(read_xyz, text);
}

Rgbf decoded(Rgb8 code)
{
    return to_float(srgb_eotf(code));
}

TEST(XyzReader, ReadsTheSampleWithTheCountOfItsSource)
{
    const std::string file = cloud("points_agisoft.xyz");
    const Result<Mesh> mesh = xyz(file);
    ASSERT_TRUE(mesh) << mesh.error().detail;
    EXPECT_EQ(broken_promise(*mesh, file.size()), "");
    EXPECT_EQ(mesh->format, "xyz");
    EXPECT_EQ(mesh->positions.size(), 100U);
    EXPECT_EQ(mesh->positions[0], (Point3{665187.522077, 5648349.895035, 241.767693}));
    EXPECT_TRUE(mesh->double_positions) << "float would move points by a quarter of a metre";
    EXPECT_EQ(mesh->colors.at(0), decoded({117, 73, 49}));
}

TEST(XyzReader, ReadsTheSamePointsWhateverSeparatesThem)
{
    const Result<Mesh> reference = xyz("1 2 3\n4 5 6.5\n");
    ASSERT_TRUE(reference);
    EXPECT_EQ(reference->positions, (std::vector<Point3>{{1, 2, 3}, {4, 5, 6.5}}));
    EXPECT_FALSE(reference->double_positions);
    EXPECT_FALSE(xyz("0.1 0.2 0.3\n5 6 7\n")->double_positions) << "nor more digits than float has";
    for (const char* text :
         {"1,2,3\n4,5,6.5", "1;2;3\r\n4;5;6.5\r\n", "1, 2 ,3\n4 ,5, 6.5,\n", "\t1\t2\t3\r4 5\t6.5",
          "# who\n// why\n\n1 2 3 # here\n\n4 5 6.5 // there\n",
          "\xEF\xBB\xBF+1 2. 3e0\n4 5 65e-1"}) {
        const Result<Mesh> mesh = xyz(text);
        ASSERT_TRUE(mesh) << text << mesh.error().detail;
        EXPECT_TRUE(same(*mesh, *reference)) << text;
    }
}

TEST(XyzReader, TellsColumnsApartByTheirNumberAndRange)
{
    const auto kinds = [](std::string_view text) {
        const Result<Mesh> mesh = xyz(text);
        if (!mesh) { return mesh.error().detail; }
        return std::string(mesh->colors.empty() ? "" : "colours ") +
               (mesh->normals.empty() ? "" : "normals");
    };
    EXPECT_EQ(kinds("1 2 3\n"), "");
    EXPECT_EQ(kinds("1 2 3 -900\n"), "");
    EXPECT_EQ(kinds("1 2 3 255 0 7\n1 2 3 0 0 0\n"), "colours ");
    EXPECT_EQ(kinds("1 2 3 0.25 0 1\n"), "colours ");
    EXPECT_EQ(kinds("1 2 3 0 -.6 .8\n1 2 3 0 0 1\n"), "normals");
    EXPECT_EQ(kinds("1 2 3 0 .6 .8\n1 2 3 0 0 0\n"), "normals") << "a point without a normal";
    EXPECT_EQ(kinds("1 2 3 0 0 1\n1 2 3 0 1 0\n"), "normals");
    EXPECT_EQ(kinds("1 2 3 0 -3 4\n"), "normals") << "need not be unit";
    EXPECT_EQ(kinds("1 2 3 0 0 0\n"), "colours ");
    EXPECT_EQ(kinds("1 2 3 -9 255 0 7\n"), "colours ");
    EXPECT_EQ(kinds("1 2 3 255 0 7 0 .6 -.8\n"), "colours normals");
    EXPECT_EQ(kinds("1 2 3 0 .6 -.8 255 0 7\n"), "colours normals");
}

TEST(XyzReader, PutsEachTripleOfNineColumnsWhereItBelongs)
{
    const Result<Mesh> colors_first =
        xyz("1 2 3 255 0 7 0 .6 -.8\n1 2 3 0 1 0 0 0 1\n1 2 3 9 9 9 0 0 0\n");
    const Result<Mesh> normals_first =
        xyz("1 2 3 0 .6 -.8 255 0 7\n1 2 3 0 0 1 0 1 0\n1 2 3 0 0 0 9 9 9\n");
    ASSERT_TRUE(colors_first && normals_first);
    EXPECT_TRUE(same(*colors_first, *normals_first));
    EXPECT_EQ(colors_first->colors[0], decoded({255, 0, 7}));
    EXPECT_EQ(colors_first->normals, (std::vector<Vec3>{{0, .6, -.8}, {0, 0, 1}, {}}));
}

TEST(XyzReader, TakesColoursUpToOneAsLinear)
{
    const Result<Mesh> shares = xyz("1 2 3 9 0.25 0 1\n1 2 3 9 1 1 0\n");
    ASSERT_TRUE(shares);
    EXPECT_EQ(shares->colors, (std::vector<Rgbf>{{.25F, 0, 1}, {1, 1, 0}}));
    const Result<Mesh> codes = xyz("1 2 3 9 2 0 1\n1 2 3 9 1 1.0 0\n");
    ASSERT_TRUE(codes);
    EXPECT_EQ(codes->colors[1], decoded({1, 1, 0}));
}

TEST(XyzReader, FollowsALineOfNames)
{
    const Result<Mesh> reference = xyz("1 2 3 9 8 7 0 0 1\n");
    ASSERT_TRUE(reference);
    for (const char* text :
         {"x y z r g b nx ny nz\n1 2 3 9 8 7 0 0 1",
          "X,Y,Z,Red,Green,Blue,Normal_X,Normal_Y,NormalZ\n1,2,3,9,8,7,0,0,1\n",
          "\"nz\" \"ny\" \"nx\" \"blue\" \"green\" \"red\" \"z\" \"y\" \"x\"\n1 0 0 7 8 9 3 2 1\n",
          "//X Y Z R G B Nx Ny Nz\n1 2 3 9 8 7 0 0 1\n",
          "# by hand\nx y label z r time g b nx ny nz\n1 2 oak 3 9 - 8 7 0 0 1\n"}) {
        const Result<Mesh> mesh = xyz(text);
        ASSERT_TRUE(mesh) << text << mesh.error().detail;
        EXPECT_TRUE(same(*mesh, *reference)) << text;
    }
    const Result<Mesh> rest = xyz("x y z intensity r g\n1 2 3 a b c\n");
    ASSERT_TRUE(rest) << rest.error().detail;
    EXPECT_TRUE(rest->colors.empty());
    EXPECT_TRUE(notes_say(*rest, "'intensity', 'r', 'g'"));
    // A comment is no line of names unless its number of words fits.
    const Result<Mesh> comment = xyz("# x y z in metres\n1 2 3 9 8 7\n");
    ASSERT_TRUE(comment);
    EXPECT_EQ(comment->colors.size(), 1U);
}

TEST(XyzReader, RefusesBrokenFilesAtTheirLine)
{
    const Refusal rows[] = {
        {"", Fault::EmptyFile, -1, -1, "no bytes"},
        {"# nothing\n\n", Fault::NoGeometry, -1, -1, "no points"},
        {"x y z\n", Fault::NoGeometry, -1, -1, "no points"},
        {"1 2\n", Fault::MalformedBody, 1, -1, "rows of 2 numbers; without names there may be 3"},
        {"\n1 2 3 4 5\n", Fault::MalformedBody, 2, -1, "rows of 5 numbers"},
        {"1 2 3 4 5 6 7 8\n", Fault::MalformedBody, 1, -1, "line of names"},
        {"1 2 3 4 5 6 7 8 9 10\n", Fault::MalformedBody, 1, -1, "rows of 10"},
        {"1 2 3\n1 2 3 4\n", Fault::MalformedBody, 2, -1, "a row of 4 fields; line 1 has 3"},
        {"1 2 3\n1 2\n", Fault::MalformedBody, 2, -1, "a row of 2 fields"},
        {"x y z\n1 2 3\n1 2\n", Fault::MalformedBody, 3, -1, "line 1 has 3"},
        {"1 2 3\n1 2 b\n", Fault::MalformedBody, 2, -1, "'b' is no number"},
        {"1 2 3 x\n", Fault::MalformedBody, 1, -1, "'x' is no number"},
        {"1,2,3\n1,,3\n", Fault::MalformedBody, 2, -1, "between two separators"},
        {",1,2\n", Fault::MalformedBody, 1, -1, "nothing stands"},
        {"hello world\n1 2\n", Fault::MalformedHeader, 1, -1, "'hello'"},
        {"x y\n1 2\n", Fault::MalformedHeader, 1, -1, "names with x, y and z"},
        {"x y z X\n1 2 3 4\n", Fault::MalformedHeader, 1, -1, "two columns have the name 'X'"},
        {"1 2 nan\n", Fault::NonFiniteCoordinate, 1, -1, "not finite"},
        {"1 2 3\n-inf 2 3\n", Fault::NonFiniteCoordinate, 2, -1, "not finite"},
        {"1 2 -2e15\n", Fault::CoordinateTooLarge, 1, -1, "1e15"},
        {"1 2 3 0 256 0 0\n", Fault::MalformedBody, 1, -1, "whole numbers 0 to 255"},
        {"1 2 3 300 256 0\n", Fault::MalformedBody, 1, -1, "whole numbers 0 to 255"},
        {"1 2 3 0 25 9 7\n1 2 3 0 1 1 .5\n", Fault::MalformedBody, 2, -1, "neither"},
        {"1 2 3 0 .5 0 0\n1 2 3 0 9 0 0\n", Fault::MalformedBody, 2, -1, "neither"},
        {"1 2 3 0 25 9 7\n1 2 3 0 1 1 -1\n", Fault::MalformedBody, 2, -1, "neither"},
        {"#\n1 2 3 9 9 9 8 8 8\n", Fault::MalformedBody, 2, -1, "none of the triples"},
        {"1 2 3 0 0 1 0 1 0\n", Fault::MalformedBody, 1, -1, "both of the triples"},
    };
    for (const Refusal& row : rows) { expect_refused(read_xyz, row); }
    expect_refused(read_xyz, {"1 2 3\n1 2 3\n", Fault::TooManyVertices, 2, -1, "limit of 1"},
                   {1, 1});
}

TEST(PtsReader, ReadsTheSampleWithTheCountOfItsSource)
{
    const std::string file = cloud("test.pts");
    const Result<Mesh> mesh = read(read_pts, file);
    ASSERT_TRUE(mesh) << mesh.error().detail;
    EXPECT_EQ(broken_promise(*mesh, file.size()), "");
    EXPECT_EQ(mesh->format, "pts");
    EXPECT_EQ(mesh->positions.size(), 19U);
    EXPECT_EQ(mesh->positions[0], (Point3{3.980972, -2.006119, -0.010086}));
    EXPECT_EQ(mesh->colors.at(0), decoded({97, 59, 38}));
    EXPECT_TRUE(notes_say(*mesh, "intensity left out"));
}

TEST(PtsReader, JoinsItsBlocks)
{
    const Result<Mesh> mesh = read(read_pts, "2\n1 2 3\n4 5 6\n0\n\n1\n7 8 9\n");
    ASSERT_TRUE(mesh) << mesh.error().detail;
    EXPECT_EQ(mesh->positions, (std::vector<Point3>{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}));
}

TEST(PtsReader, RefusesACountThatIsNotThatOfTheRows)
{
    const Refusal rows[] = {
        {"", Fault::EmptyFile, -1, -1, "no bytes"},
        {"0\n", Fault::NoGeometry, -1, -1, "no points"},
        {"1 2 3\n", Fault::MalformedHeader, 1, -1, "format xyz"},
        {"-1\n1 2 3\n", Fault::MalformedHeader, 1, -1, "number of points"},
        {"1.5\n1 2 3\n", Fault::MalformedHeader, 1, -1, "number of points"},
        {"1\n1 2 3\n4 5 6\n", Fault::MalformedBody, 3, -1, "more rows than were announced"},
        {"3\n1 2 3\n4 5 6\n# long enough\n", Fault::Truncated, 5, -1, "after 2 of the 3"},
        {"3\n1 2 3\n4 5 6\n1\n7 8 9\n", Fault::MalformedBody, 4, -1, "after 2 of the 3"},
        {"9\n1 2 3\n", Fault::CountExceedsFile, 1, -1, "announces 9 points"},
        {"99999999999999999999\n1 2 3\n", Fault::CountExceedsFile, 1, -1, "announces"},
        {"9223372036854775807\n1 2 3\n", Fault::CountExceedsFile, 1, -1, "announces"},
        {"1\n1 2\n# fill\n", Fault::MalformedBody, 2, -1, "rows of 2"},
        {"1\n1 2 3\n1\n1 2 3 4\n", Fault::MalformedBody, 4, -1, "a row of 4 fields; line 2 has 3"},
    };
    for (const Refusal& row : rows) { expect_refused(read_pts, row); }
    expect_refused(read_pts, {"2\n1 2 3\n1 2 3\n", Fault::TooManyVertices, 3, -1, "limit of 1"},
                   {1, 1});
}

TEST(XyzReader, StopsWhenTold)
{
    const std::string text = "1 2 3\n";
    Progress progress;
    progress.stop();
    EXPECT_EQ(read_xyz(std::as_bytes(std::span(text)), {}, progress).error().fault,
              Fault::Cancelled);
}

TEST(XyzReader, KeepsItsPromisesOnBrokenText)
{
    const std::string full = "x y z r g b nx ny nz\n1 2 3 9 8 7 0 0 1\n4 5 6 9 8 200 0 .6 .8\n";
    EXPECT_EQ(broken_promise_of_mutants(read_xyz, full, 6000, 1), "");
    EXPECT_EQ(broken_promise_of_mutants(read_xyz, "1,2,3,9,8,7\n4,5,6,7,8,9\n", 6000, 2), "");
    EXPECT_EQ(broken_promise_of_mutants(read_pts, "2\n1 2 3 9 8 7\n4 5 6 7 8 9\n", 6000, 3), "");
    EXPECT_EQ(broken_promise_of_mutants(read_pts, cloud("test.pts"), 2000, 4), "");
}

}  // namespace
}  // namespace relight::test
