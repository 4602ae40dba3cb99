#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>
#include <random>
#include <sstream>

#include "tests/io/reader_checks.h"

namespace relight::test {
namespace {

const std::string data = RELIGHT_TEST_DATA;

Result<Mesh> obj(std::string_view text, const ReadLimits& limits = {})
{
    return read(read_obj, text, limits);
}

Mesh sample(const std::string& name)
{
    const Result<Mesh> mesh = obj(contents(data + "/meshes/" + name));
    EXPECT_TRUE(mesh) << name << ": " << mesh.error().detail;
    return mesh ? *mesh : Mesh{};
}

void expect_refused(std::string_view text, Fault fault, std::uint64_t line)
{
    const Result<Mesh> mesh = obj(text);
    ASSERT_FALSE(mesh) << text.substr(0, 200);
    EXPECT_EQ(fault_code(mesh.error().fault), fault_code(fault)) << mesh.error().detail;
    EXPECT_EQ(mesh.error().line.value_or(0), line) << mesh.error().detail;
    EXPECT_FALSE(mesh.error().detail.empty());
}

constexpr std::string_view triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

TEST(ObjReader, ReadsEverySampleWithTheCountsOfItsSource)  // tests/data/meshes, counted by others
{
    struct Row {
        const char* file;
        std::size_t vertices, faces;
    };
    for (const Row& row :
         {Row{"utah_teapot_npm.obj", 792, 992}, Row{"suzanne.obj", 507, 500},
          Row{"spot.obj", 2930, 5856}, Row{"cornell_box.obj", 76, 17}, Row{"spider.obj", 762, 1368},
          Row{"cube_with_vertexcolors.obj", 8, 12}, Row{"concave_polygon.obj", 64, 1},
          Row{"number_formats.obj", 15, 1}, Row{"box_longline.obj", 8, 6},
          Row{"dodecahedron_poly.obj", 20, 12}, Row{"moebius.obj", 280, 224},
          Row{"box-negative-indices.obj", 8, 6}, Row{"box-incorrect-winding-order.obj", 8, 12},
          Row{"non_manifold_wrap.obj", 10, 12}}) {
        const std::string file = contents(data + "/meshes/" + row.file);
        const Result<Mesh> mesh = obj(file);
        ASSERT_TRUE(mesh) << row.file << ": " << mesh.error().detail;
        EXPECT_EQ(mesh->positions.size(), row.vertices) << row.file;
        EXPECT_EQ(mesh->faces.count(), row.faces) << row.file;
        EXPECT_EQ(broken_promise(*mesh, file.size()), "") << row.file;
        EXPECT_EQ(mesh->format, "obj");
        EXPECT_FALSE(mesh->double_positions) << row.file;
    }
}

TEST(ObjReader, ReadsTheBunnyOfTheExtraSamples)  // whose licence keeps it out of this repository
{
    const char* samples = std::getenv("RELIGHT_SAMPLES");
    const std::string file =
        samples == nullptr ? "" : contents(samples + std::string("/meshes/stanford_bunny_npm.obj"));
    if (file.empty()) {
        GTEST_SKIP() << "RELIGHT_SAMPLES names no directory with meshes/stanford_bunny_npm.obj";
    }
    const Result<Mesh> mesh = obj(file);
    ASSERT_TRUE(mesh) << mesh.error().detail;
    EXPECT_EQ(mesh->positions.size(), 1839U);
    EXPECT_EQ(mesh->faces.count(), 3674U);
}

TEST(ObjReader, ReadsEverySpellingOfANumber)
{
    const Mesh mesh = sample("number_formats.obj");
    const std::vector<Point3> expected{
        {0, 0, 0},          {1, 2, 3},         {1, 2, 3},          {-1, -2, -3},
        {100, 20, 310},     {100, 20, 310},    {-100, -20, -310},  {100, 20, 310},
        {100, 20, 310},     {-100, -20, -310},                      // 3.1+e2
        {.01, .2, .031},    {.01, .2, .031},   {-.01, -.2, -.031},  // 3.1-e2
        {1e10, 20, 3.1e10}, {100, 20, 310}};
    EXPECT_EQ(mesh.positions, expected);
    EXPECT_TRUE(notes_say(mesh, "6 numbers have their exponent's sign before its letter"));

    const Result<Mesh> more = obj("v .5 -.5 +.5\nv 1.E+05 1e-400 -0\nv 00012 0.1 1e0\n");
    ASSERT_TRUE(more) << more.error().detail;
    EXPECT_EQ(more->positions, (std::vector<Point3>{{.5, -.5, .5}, {1e5, 0, 0}, {12, .1, 1}}));
}

TEST(ObjReader, ContinuesALineThatEndsInABackslash)
{
    const Mesh longline = sample("box_longline.obj");
    EXPECT_GT(longline.faces.end(0), 900U);
    for (std::size_t c = 0; c < longline.faces.end(0); ++c) {
        EXPECT_EQ(longline.faces.indices[c], c % 4);
    }

    const Result<Mesh> broken =
        obj("v 0 \\\r\n 0 0\nv 1 0\\\n 0\nv 0 1 0 \\ \n# a comment ends with its line \\\nf 1 "
            "2\\\n\\\n3");
    ASSERT_TRUE(broken) << broken.error().detail;
    EXPECT_EQ(broken->positions, (std::vector<Point3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
    EXPECT_EQ(broken->faces.indices, (std::vector<std::uint32_t>{0, 1, 2}));
}

TEST(ObjReader, ResolvesNegativeIndicesFromWhatIsFiledSoFar)
{
    // The file's own faces as 1-based indices: the last vertex is filed after the first three
    // faces.
    const Mesh mesh = sample("box-negative-indices.obj");
    const std::vector<std::uint32_t> expected{0, 1, 3, 2, 4, 5, 1, 0, 2, 6, 4, 0,
                                              7, 3, 1, 5, 2, 3, 7, 6, 6, 7, 5, 4};
    EXPECT_EQ(mesh.faces.indices, expected);
    const Result<Mesh> later = obj("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n");
    ASSERT_TRUE(later) << "positive indices may look ahead: " << later.error().detail;
    EXPECT_EQ(later->faces.indices, (std::vector<std::uint32_t>{0, 1, 2, 0, 1, 2}));
}

TEST(ObjReader, TakesColoursAsLinearFloats)
{
    const Mesh mesh = sample("cube_with_vertexcolors.obj");
    ASSERT_EQ(mesh.colors.size(), 8U);
    EXPECT_EQ(mesh.colors[0], (Rgbf{0.48627F, 0.43137F, 0.47059F}));
    EXPECT_EQ(mesh.colors[7], (Rgbf{0.09020F, 0.00000F, 0.78431F}));

    const Result<Mesh> mixed =
        obj("v 1 2 3\nv 1 2 3 1\nv 1 2 3 .5\nv 1 2 3 .1 .2 .3\nv 1 2 3 1 .4 .5 .6\nv 1 2 3\n");
    ASSERT_TRUE(mixed) << mixed.error().detail;
    const Rgbf white{1, 1, 1};
    EXPECT_EQ(mixed->colors,
              (std::vector<Rgbf>{white, white, white, {.1F, .2F, .3F}, {.4F, .5F, .6F}, white}));
    EXPECT_TRUE(notes_say(*mixed, "1 vertices have a weight"));
    EXPECT_TRUE(notes_say(*mixed, "4 vertices have no colour"));
}

TEST(ObjReader, KeepsMaterialNamesInTheOrderFacesUseThem)
{
    const Mesh mesh =
        sample("cornell_box.obj");  // the faces of "light" and "blue" are commented out
    EXPECT_EQ(mesh.materials, (std::vector<std::string>{"white", "green", "red"}));
    ASSERT_EQ(mesh.face_materials.size(), 17U);
    std::vector<std::uint32_t> expected(17, 0);
    expected[5] = 1;
    expected[6] = 2;
    EXPECT_EQ(mesh.face_materials, expected);
    EXPECT_TRUE(notes_say(mesh, "mtllib"));
    EXPECT_EQ(sample("spider.obj").materials,
              (std::vector<std::string>{"HLeibTex", "Skin", "BeinTex", "Augentex"}));

    const Result<Mesh> late = obj(
        std::string(triangle) +
        "f 1 2 3\nusemtl  Wood #2 \r\nf 1 2 3\nusemtl Gl\xFCh\nf 3 2 1\nusemtl Wood #2\nf 2 3 1\n");
    ASSERT_TRUE(late) << late.error().detail;
    EXPECT_EQ(late->materials, (std::vector<std::string>{"", "Wood #2", "Glüh"}))
        << "Latin-1 becomes UTF-8";
    EXPECT_EQ(late->face_materials, (std::vector<std::uint32_t>{0, 1, 2, 1}));
}

TEST(ObjReader, GivesAVertexItsTextureCoordinatesIfItsCornersAgree)
{
    const std::string vt =
        std::string(triangle) + "v 1 1 0\nvt 0 0\nvt 1 0\nvt .5 1 7\nvt .25\nvt 1 0\n";
    const Result<Mesh> agree =
        obj(vt + "f 1/1 2/2 3/3\nf 3/3/ 2/5 4\n");  // vt 5 says what vt 2 says
    ASSERT_TRUE(agree) << agree.error().detail;
    EXPECT_TRUE(agree->corner_uvs.empty());
    EXPECT_EQ(agree->uvs, (std::vector<std::array<float, 2>>{{0, 0}, {1, 0}, {.5F, 1}, {0, 0}}));
    EXPECT_TRUE(notes_say(*agree, "1 face corners name no vt"));

    const Result<Mesh> differ = obj(vt + "f 1 2 4\nf 1/1 2/2 3/3\nf 3/3 2/4 4\n");
    ASSERT_TRUE(differ) << differ.error().detail;
    EXPECT_TRUE(differ->uvs.empty());
    EXPECT_EQ(differ->corner_uvs,
              (std::vector<std::array<float, 2>>{
                  {0, 0}, {0, 0}, {0, 0}, {0, 0}, {1, 0}, {.5F, 1}, {.5F, 1}, {.25F, 0}, {0, 0}}));

    const Mesh spot = sample("spot.obj");  // seams: 3225 vt for 2930 v
    EXPECT_EQ(spot.corner_uvs.size(), 3U * 5856U);
}

TEST(ObjReader, GivesAVertexTheNormalItsCornersAgreeUpon)
{
    const std::string vn =
        std::string(triangle) + "v 1 1 0\nv 9 9 9\nvn 0 0 2\nvn 0 3 0\nvn 0 0 -1\nvn 0 0 2\n";
    const Result<Mesh> mesh =
        obj(vn + "f 1//1 2//1 3//1\nf 2//2 3//4 1//4\nf 2//2 4//1 3//1\nf 2//4 4//3 3//1\n");
    ASSERT_TRUE(mesh) << mesh.error().detail;
    ASSERT_EQ(mesh->normals.size(), 5U);
    EXPECT_EQ(mesh->normals[0], (Vec3{0, 0, 2})) << "as filed; vn 4 says what vn 1 says";
    EXPECT_NEAR(mesh->normals[1].y, std::sqrt(.5), 1e-15) << "(0,0,1) + (0,1,0), each counted once";
    EXPECT_NEAR(mesh->normals[1].z, std::sqrt(.5), 1e-15);
    EXPECT_EQ(mesh->normals[3], Vec3{}) << "opposite normals leave none";
    EXPECT_EQ(mesh->normals[4], Vec3{}) << "no face, no normal";
    EXPECT_TRUE(notes_say(*mesh, "2 vertices have several normals"));

    const Result<Mesh> unused = obj(vn + "f 1 2 3\n");
    ASSERT_TRUE(unused);
    EXPECT_TRUE(unused->normals.empty());
    EXPECT_TRUE(notes_say(*unused, "4 vn lines are used by no face"));
}

TEST(ObjReader, GivesABoxOfHardEdgesItsDiagonals)
{
    // Each corner of an axis-aligned box meets three faces: their normals sum to the diagonal (±1,
    // ±1, ±1).
    const Mesh mesh = sample("cube_with_vertexcolors.obj");
    ASSERT_EQ(mesh.normals.size(), 8U);
    for (std::size_t v = 0; v < 8; ++v) {
        const Vec3 diagonal = normalize(mesh.positions[v] - Point3{.5, .5, .5});
        EXPECT_NEAR(std::abs(dot(mesh.normals[v], diagonal)), 1.0, 1e-12) << v;
        EXPECT_NEAR(length(mesh.normals[v]), 1.0, 1e-12) << v;
    }
}

TEST(ObjReader, TakesVerticesWithoutFacesAsAPointCloud)
{
    const Result<Mesh> cloud = obj("vn 0 0 1\nv 1 2 3\nvn 0 1 0\nv 4 5 6\np 1 2\nl 1 2\nl 2 1\n");
    ASSERT_TRUE(cloud) << cloud.error().detail;
    EXPECT_EQ(cloud->faces.count(), 0U);
    EXPECT_EQ(cloud->normals, (std::vector<Vec3>{{0, 0, 1}, {0, 1, 0}}));
    EXPECT_TRUE(notes_say(*cloud, "1 point elements"));
    EXPECT_TRUE(notes_say(*cloud, "2 line elements"));
    const Result<Mesh> fewer = obj("vn 0 0 1\nv 1 2 3\nv 4 5 6\n");
    ASSERT_TRUE(fewer);
    EXPECT_TRUE(fewer->normals.empty());
}

TEST(ObjReader, SaysWhichKeywordsItLeavesOut)
{
    const Result<Mesh> mesh = obj("\xEF\xBB\xBFg a\no b\ns off\n" + std::string(triangle) +
                                  "curv 0 1 \\\n 1 2\ncstype bezier\ncurv 1\nf 1 2 3 # a comment");
    ASSERT_TRUE(mesh) << mesh.error().detail;
    EXPECT_EQ(mesh->notes,
              (std::vector<std::string>{"3 lines of other keywords left out: 'curv', 'cstype'"}));
}

TEST(ObjReader, KeepsDoublesWhereFloatWouldLoseThem)
{
    const Result<Mesh> far =
        obj("v 4500000.125 5400000.375 100.0625\nv 4500001 5400000 100\nv 4500000 5400001.5 101\n");
    ASSERT_TRUE(far);
    EXPECT_TRUE(far->double_positions);
    EXPECT_EQ(far->positions[0], (Point3{4500000.125, 5400000.375, 100.0625}));
}

TEST(ObjReader, RefusesBrokenFilesAtTheirLine)
{
    const auto broken = [](const char* name) { return contents(data + "/broken/" + name); };
    expect_refused(broken("a_obj_index_overflow.obj"), Fault::IndexOutOfRange, 4);
    expect_refused(broken("a_obj_relative_index_too_far.obj"), Fault::IndexOutOfRange, 4);
    expect_refused(broken("assimp_malformed.obj"), Fault::IndexOutOfRange, 28);  // f 0 7 8 5
    expect_refused(broken("trimesh_notenoughindices.obj"), Fault::MalformedBody, 9);
    expect_refused(broken("draco_inf_nan.obj"), Fault::NonFiniteCoordinate, 1);

    // Legal, if extreme: a triangle without area casts no shadow and harms nothing, and a comment
    // may be long.
    for (const char* legal : {"draco_degenerate_mesh.obj", "a_obj_million_char_line.obj"}) {
        const Result<Mesh> mesh = obj(broken(legal));
        ASSERT_TRUE(mesh) << legal << ": " << mesh.error().detail;
        EXPECT_EQ(mesh->positions.size(), 3U);
        EXPECT_EQ(mesh->faces.indices.size(), 3U);
    }
}

TEST(ObjReader, RefusesWhatIsNotAnObj)
{
    const std::string t(triangle);
    expect_refused("", Fault::EmptyFile, 0);
    expect_refused("# nothing\n\n", Fault::NoGeometry, 0);
    expect_refused("vn 0 0 1\nf 1 2 3\n", Fault::NoGeometry, 0);
    expect_refused("v 1 2\n", Fault::MalformedBody, 1);
    expect_refused("v 1 2 3 4 5\n", Fault::MalformedBody, 1);
    expect_refused("v 1 2 3 4 5 6 7 8\n", Fault::MalformedBody, 1);
    expect_refused("v 1 2 x\n", Fault::MalformedBody, 1);
    expect_refused("v 1,5 2 3\n", Fault::MalformedBody, 1);
    expect_refused("v 0x1p3 2 3\n", Fault::MalformedBody, 1);
    expect_refused("v 1 2 3+e\n", Fault::MalformedBody, 1);
    expect_refused(t + "v 1 2 -nan(ind)\n", Fault::NonFiniteCoordinate, 4);
    expect_refused(t + "v 1 2 1.#QNAN\n", Fault::NonFiniteCoordinate, 4);
    expect_refused(t + "v 1 2 1.1e15\n", Fault::CoordinateTooLarge, 4);
    expect_refused(t + "v 1 2 1e999\n", Fault::CoordinateTooLarge, 4);
    expect_refused(t + "vn 1 2\n", Fault::MalformedBody, 4);
    expect_refused(t + "vn 1 2 nan\n", Fault::NonFiniteCoordinate, 4);
    expect_refused(t + "vt\n", Fault::MalformedBody, 4);
    expect_refused(t + "vt 1 2 3 4\n", Fault::MalformedBody, 4);
    expect_refused(t + "vt inf\n", Fault::NonFiniteCoordinate, 4);
    expect_refused(t + "f 1 2\n", Fault::MalformedBody, 4);
    expect_refused(t + "f\n", Fault::MalformedBody, 4);
    expect_refused(t + "f 1 2 x\n", Fault::MalformedBody, 4);
    expect_refused(t + "f 1 2 3.0\n", Fault::MalformedBody, 4);
    expect_refused(t + "f 1 2 /3\n", Fault::MalformedBody, 4);
    expect_refused(t + "f 1 2 3/1/1/1\n", Fault::MalformedBody, 4);
    expect_refused(t + "f 0 1 2\n", Fault::IndexOutOfRange, 4);
    expect_refused(t + "f 1 2 4\nv 1 1 1 1 1\n", Fault::MalformedBody, 5);
    expect_refused(t + "f 1 2 4\n\n", Fault::IndexOutOfRange, 4);
    expect_refused(t + "f 1 2 4294967297\n", Fault::IndexOutOfRange, 4);
    expect_refused(t + "f 1 2 -9223372036854775808\n", Fault::IndexOutOfRange, 4);
    expect_refused(t + "f 1/1 2/1 3/1\n", Fault::IndexOutOfRange, 4);
    expect_refused(t + "vt 0 0\nf 1/1 2/1 \\\n3/2\n", Fault::IndexOutOfRange, 5);
    expect_refused(t + "vn 0 0 1\nf 1//1 2//1 3//-2\n", Fault::IndexOutOfRange, 5);
    expect_refused(t + "\r\r\r\nf 1 2 9\r", Fault::IndexOutOfRange,
                   7);  // CR, CR and CR LF are three lines
}

TEST(ObjReader, HoldsToItsLimits)
{
    const std::string two = std::string(triangle) + "f 1 2 3\nf 3 2 1\n";
    ASSERT_TRUE(obj(two, {3, 2}));
    const Result<Mesh> vertices = obj(two, {2, 2});
    ASSERT_FALSE(vertices);
    EXPECT_EQ(vertices.error().fault, Fault::TooManyVertices);
    EXPECT_EQ(vertices.error().line, 3U);
    const Result<Mesh> faces = obj(two, {3, 1});
    ASSERT_FALSE(faces);
    EXPECT_EQ(faces.error().fault, Fault::TooManyFaces);
    EXPECT_EQ(faces.error().line, 5U);
}

TEST(ObjReader, StopsWhenTold)
{
    std::string text(triangle);
    for (int i = 0; i < 70'000; ++i) { text += "f 1 2 3\n"; }
    std::string polygon = std::string(triangle) + "f";
    for (int i = 0; i < 70'000; ++i) { polygon += " 1 2 3"; }
    for (const std::string& file : {text, polygon}) {
        ASSERT_TRUE(obj(file));
        Progress progress;
        progress.stop();
        const Result<Mesh> mesh = read_obj(std::as_bytes(std::span(file)), {}, progress);
        ASSERT_FALSE(mesh);
        EXPECT_EQ(mesh.error().fault, Fault::Cancelled);
    }
}

/// One mesh, spelled as `random` likes: every choice below is legal and none may change what is
/// read.
class Speller {
  public:
    explicit Speller(unsigned seed) : random_(seed) {}

    std::string spell()
    {
        end_ = pick({"\n", "\r\n", "\r"});
        out_ = one_in(3) ? "# head" + end_ : "";
        const bool all_first = one_in(2);
        for (int i = 0; i < 6; ++i) {
            line("v", {number(i), number(i * i - 3), number(0.25 * i), number(1), number(0.5),
                       number(0)});
            line("vt", {number(0.125 * i), number(1)});
            line("vn", {number(i - 2), number(2), number(-1)});
            if (i == 3 && !all_first) { faces(4); }
        }
        if (all_first) { faces(6); }
        line("usemtl", {"paint"});
        face({3, 4, 5, 0}, 6);
        return out_;
    }

  private:
    bool one_in(unsigned n) { return random_() % n == 0; }
    std::string pick(std::vector<std::string> of) { return of[random_() % of.size()]; }

    std::string number(double x)
    {
        std::ostringstream plain;
        plain << std::fixed << std::abs(x);  // six decimals: exact for these
        std::ostringstream tenfold;
        tenfold << std::fixed << std::abs(x) * 10.0 << pick({"e-1", "E-01", "e-1"});
        return (x < 0 ? "-" : pick({"", "+"})) + (one_in(2) ? plain.str() : tenfold.str());
    }

    void line(const std::string& keyword, const std::vector<std::string>& words)
    {
        const bool name = keyword == "usemtl";  // a name would swallow a comment or backslash
        out_ += pick({"", " ", "\t"}) + keyword;
        for (const std::string& word : words) {
            out_ += pick({" ", "\t", "  "});
            if (!name && one_in(6)) { out_ += "\\" + end_; }
            out_ += word;
        }
        out_ += pick({"", " ", name ? "" : " # said"}) + end_;
        if (one_in(4)) {
            out_ += pick({"", "g part", "s 1", "o thing", "# f 1 2 3", "\t "}) + end_;
        }
    }

    void faces(int filed)
    {
        face({0, 1, 2}, filed);
        face({2, 1, 3}, filed);
        face({0, 3, 1, 2}, filed);
    }

    void face(const std::vector<int>& corners, int filed)
    {
        std::vector<std::string> words;
        words.reserve(corners.size());
        const auto index = [&](int i) { return std::to_string(one_in(2) ? i + 1 : i - filed); };
        for (const int c : corners) {
            words.push_back(index(c) + "/" + index(c) + "/" + index((c + 1) % filed));
        }
        line(one_in(8) ? "fo" : "f", words);
    }

    std::mt19937 random_;
    std::string end_, out_;
};

TEST(ObjReader, ReadsTheSameMeshFromEveryLegalSpelling)
{
    std::vector<Mesh>
        reference;  // faces in the middle of the file name the normals so far: two meshes
    for (unsigned seed = 0; seed < 400; ++seed) {
        const std::string text = Speller(seed).spell();
        const Result<Mesh> mesh = obj(text);
        ASSERT_TRUE(mesh) << mesh.error().detail << "\n" << text;
        ASSERT_EQ(mesh->positions.size(), 6U);
        ASSERT_EQ(mesh->face_materials, (std::vector<std::uint32_t>{0, 0, 0, 1}));
        ASSERT_EQ(mesh->faces.indices,
                  (std::vector<std::uint32_t>{0, 1, 2, 2, 1, 3, 0, 3, 1, 2, 3, 4, 5, 0}));
        const auto known = std::any_of(reference.begin(), reference.end(),
                                       [&](const Mesh& m) { return same(m, *mesh); });
        if (!known) { reference.push_back(*mesh); }
        ASSERT_LE(reference.size(), 2U) << text;
    }
}

TEST(ObjReader, KeepsItsPromisesOnBrokenText)
{
    const std::string cube = contents(data + "/meshes/cube_with_vertexcolors.obj");
    const std::string negative = contents(data + "/meshes/box-negative-indices.obj");
    EXPECT_EQ(broken_promise_of_mutants(read_obj, cube, 3000, 1), "");
    EXPECT_EQ(broken_promise_of_mutants(read_obj, negative, 3000, 2), "");
    EXPECT_EQ(broken_promise_of_mutants(read_obj, Speller(7).spell(), 6000, 3), "");
}

}  // namespace
}  // namespace relight::test
