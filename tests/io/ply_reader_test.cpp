#include <gtest/gtest.h>

#include <bit>
#include <cstdlib>
#include <filesystem>
#include <limits>

#include "core/display/display.h"
#include "tests/io/reader_checks.h"

namespace relight {
namespace {

using test::contents;
using test::read;

const std::string data = RELIGHT_TEST_DATA;

Result<Mesh> read_text(std::string_view text)
{
    return read(read_ply, text);
}

/// An ascii file: the property lines of its vertices, their values, and the faces' values.
std::string ascii(const std::string& properties, const std::vector<std::string>& vertices,
                  const std::vector<std::string>& faces = {},
                  const std::string& face_properties = "property list uchar int vertex_indices\n")
{
    std::string text = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(vertices.size()) +
                       "\n" + properties + "element face " + std::to_string(faces.size()) + "\n" +
                       face_properties + "end_header\n";
    for (const std::string& line : vertices) { text += line + "\n"; }
    for (const std::string& line : faces) { text += line + "\n"; }
    return text;
}

const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
const std::vector<std::string> corners = {"0 0 0", "1 0 0", "0 1 0"};

/// The bytes of `value` in either order.
template <class T>
std::string raw(T value, bool big_endian)
{
    const auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
    std::string out(bytes.begin(), bytes.end());
    if (big_endian) { std::reverse(out.begin(), out.end()); }
    return out;
}

struct Counts {
    const char* file;
    std::size_t vertices, faces;
};

TEST(PlySamples, HaveTheCountsOfTheirSource)  // tests/data/SOURCES.md
{
    for (const Counts& c : {Counts{"meshes/cube_binary.ply", 8, 12},
                            {"meshes/cube_binary_header_with_RN_newline.ply", 8, 12},
                            {"meshes/cube_quads.ply", 8, 6},
                            {"meshes/cube_uv.ply", 24, 6},
                            {"meshes/egyptcat.ply", 10049, 16000},
                            {"meshes/float-color.ply", 3, 1},
                            {"meshes/per-face-colors-be.ply", 5, 2},
                            {"meshes/ply_char_ushort_short_be.ply", 5, 2},
                            {"meshes/ply_pos_col_nrm_uv_float.ply", 5, 2},
                            {"meshes/ply_whitespace.ply", 5, 2},
                            {"meshes/spot.ply", 2930, 5856},
                            {"clouds/cloudcompare_simple_binary.ply", 3, 0},
                            {"clouds/colored_cloud_converted.ply", 1000, 0},
                            {"clouds/milk_color_converted_ascii.ply", 13704, 0},
                            {"clouds/point_cloud_test_pos_norm.ply", 4, 0},
                            {"clouds/points_emptyface.ply", 1024, 0}}) {
        const std::string text = contents(data + "/" + c.file);
        const Result<Mesh> mesh = read_text(text);
        ASSERT_TRUE(mesh) << c.file << ": " << mesh.error().detail;
        EXPECT_EQ(mesh->positions.size(), c.vertices) << c.file;
        EXPECT_EQ(mesh->faces.count(), c.faces) << c.file;
        EXPECT_EQ(test::broken_promise(*mesh, text.size()), "") << c.file;
    }
}

TEST(PlySamples, OfStanfordHaveTheirCounts)  // not in tests/data: their licence asks for more
{
    const char* const folder = std::getenv("RELIGHT_SAMPLES");
    for (const Counts& c : {Counts{"meshes/bun_zipper.ply", 35947, 69451},
                            {"meshes/stanford_dragon_l3.ply", 22998, 47794}}) {
        const std::string path = std::string(folder == nullptr ? "" : folder) + "/" + c.file;
        if (folder == nullptr || !std::filesystem::exists(path)) {
            GTEST_SKIP() << "RELIGHT_SAMPLES names no folder with " << c.file;
        }
        const Result<Mesh> mesh = read_text(contents(path));
        ASSERT_TRUE(mesh) << c.file << ": " << mesh.error().detail;
        EXPECT_EQ(mesh->positions.size(), c.vertices);
        EXPECT_EQ(mesh->faces.count(), c.faces);
    }
}

TEST(BrokenPly, IsRefusedForItsReasonAtItsPlace)
{
    enum Place { None, Line, Byte };
    struct Case {
        const char* file;
        Fault fault;
        Place place;
        std::uint64_t at;
    };
    // 4 or 1000 announced vertices that the file cannot hold are a count that exceeds it, whether
    // the count lies or the file was cut: which of them, nobody can tell.
    for (const Case& c :
         {Case{"a_zero_length", Fault::EmptyFile, None, 0},
          {"a_ply_truncated_body", Fault::CountExceedsFile, Byte, 172},
          {"a_ply_4g_vertices", Fault::CountExceedsFile, Byte, 178},
          {"a_ply_nan_inf", Fault::NonFiniteCoordinate, Line, 10},
          {"a_ply_negative_index", Fault::IndexOutOfRange, Line, 14},
          {"a_ply_index_out_of_range", Fault::IndexOutOfRange, Line, 14},
          {"a_ply_wrong_endian", Fault::IndexOutOfRange, Byte, 214},
          {"a_ply_list_longer_than_file", Fault::CountExceedsFile, Byte, 217},
          {"a_ply_negative_count", Fault::MalformedHeader, Line, 3},
          {"a_ply_huge_coordinates", Fault::CoordinateTooLarge, Line, 10},
          {"magnum_format-missing", Fault::MalformedHeader, Line, 6},
          {"magnum_invalid-signature", Fault::MalformedHeader, Line, 1},
          {"magnum_positions-missing", Fault::MalformedHeader, Line, 6},
          {"magnum_invalid-vertex-type", Fault::MalformedHeader, Line, 4},
          {"magnum_incomplete-face-specification", Fault::MalformedHeader, Line, 10},
          {"magnum_integer-literal-too-large", Fault::MalformedHeader, Line, 6}}) {
        const std::string path = data + "/broken/" + c.file + ".ply";
        ASSERT_TRUE(std::filesystem::exists(path)) << path;
        const Result<Mesh> mesh = read_text(contents(path));
        ASSERT_FALSE(mesh) << c.file;
        const Error& error = mesh.error();
        EXPECT_EQ(fault_code(error.fault), fault_code(c.fault)) << c.file << ": " << error.detail;
        EXPECT_EQ(error.line.value_or(0), c.place == Line ? c.at : 0) << c.file;
        EXPECT_EQ(error.byte.value_or(0), c.place == Byte ? c.at : 0) << c.file;
    }
}

// 10,000 properties are legal and cost no more than their bytes; a mesh of one point is legal and
// its faces degenerate, which the intake report says.
TEST(BrokenPly, LegalButExtremeFilesAreRead)
{
    const Result<Mesh> many = read_text(contents(data + "/broken/a_ply_10000_properties.ply"));
    ASSERT_TRUE(many) << many.error().detail;
    EXPECT_EQ(many->positions.size(), 1U);
    EXPECT_LT(many->notes.at(0).size(), 200U);  // does not name all 9,997

    const Result<Mesh> one = read_text(contents(data + "/broken/a_ply_all_same_point.ply"));
    ASSERT_TRUE(one) << one.error().detail;
    EXPECT_EQ(one->faces.count(), 2U);
}

TEST(BrokenPly, MutantsOfSamplesAreMeshesOrErrors)
{
    for (const char* folder : {"/meshes", "/clouds", "/broken"}) {
        for (const auto& entry : std::filesystem::directory_iterator(data + folder)) {
            if (entry.path().extension() != ".ply") { continue; }
            const std::string text = contents(entry.path());
            const int count = text.size() > 20'000 ? 60 : 1500;
            if (text.size() > 200'000) { continue; }  // says nothing that the smaller ones do not
            EXPECT_EQ(test::broken_promise_of_mutants(read_ply, text, count, 1), "")
                << entry.path();
        }
    }
}

/// A triangle whose coordinates and indices are all filed as T, in any encoding.
template <class T>
std::string triangle_of(const std::string& type, const std::string& encoding)
{
    std::string text = "ply\nformat " + encoding + " 1.0\nelement vertex 3\n";
    for (const char* axis : {"x", "y", "z"}) { text += "property " + type + " " + axis + "\n"; }
    const std::string index = std::is_floating_point_v<T> ? "int" : type;
    text += "element face 1\nproperty list " + index + " " + index + " vertex_index\nend_header\n";
    const auto append = [&](auto value, const char* after) {
        if (encoding != "ascii") {
            text += raw(value, encoding == "binary_big_endian");
        } else {
            text += std::to_string(value) + after;
        }
    };
    for (const int coordinate : {0, 1, 2, 100, 0, 3, 7, 90, 5}) {
        append(static_cast<T>(coordinate), coordinate == 2 || coordinate == 3 ? "\n" : " ");
    }
    if (encoding == "ascii") { text.back() = '\n'; }
    using Index = std::conditional_t<std::is_floating_point_v<T>, std::int32_t, T>;
    for (const int value : {3, 2, 0, 1}) { append(static_cast<Index>(value), " "); }
    return text;
}

template <class T>
void expect_triangle(const std::string& type)
{
    for (const char* encoding : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        const Result<Mesh> mesh = read_text(triangle_of<T>(type, encoding));
        ASSERT_TRUE(mesh) << type << " " << encoding << ": " << mesh.error().detail;
        const std::vector<Point3> positions = {{0, 1, 2}, {100, 0, 3}, {7, 90, 5}};
        EXPECT_EQ(mesh->positions, positions) << type << " " << encoding;
        EXPECT_EQ(mesh->faces.indices, (std::vector<std::uint32_t>{2, 0, 1})) << type;
    }
}

TEST(ReadPly, EveryScalarTypeSaysTheSameInEveryEncoding)
{
    expect_triangle<std::int8_t>("char");
    expect_triangle<std::int8_t>("int8");
    expect_triangle<std::uint8_t>("uchar");
    expect_triangle<std::uint8_t>("uint8");
    expect_triangle<std::int16_t>("short");
    expect_triangle<std::int16_t>("int16");
    expect_triangle<std::uint16_t>("ushort");
    expect_triangle<std::uint16_t>("uint16");
    expect_triangle<std::int32_t>("int");
    expect_triangle<std::int32_t>("int32");
    expect_triangle<std::uint32_t>("uint");
    expect_triangle<std::uint32_t>("uint32");
    expect_triangle<float>("float");
    expect_triangle<float>("float32");
    expect_triangle<double>("double");
    expect_triangle<double>("float64");
}

TEST(ReadPly, AnyLineEndServesAndNoneIsTakenFromTheBody)
{
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        std::string text;
        for (const char* line :
             {"ply", "format binary_little_endian 1.0", "element vertex 1", "property uchar x",
              "property uchar y", "property uchar z", "end_header"}) {
            text += line + end;
        }
        text += "\n\n\n";  // a vertex at (10, 10, 10)
        const Result<Mesh> mesh = read_text(text);
        ASSERT_TRUE(mesh) << mesh.error().detail;
        EXPECT_EQ(mesh->positions.at(0), (Point3{10, 10, 10}));
    }
}

TEST(ReadPly, ExtraPropertiesListsAndElementsAreSkipped)
{
    const std::string text =
        "ply\nformat ascii 1.0\n"
        "element camera 1\nproperty list uchar float shift\nproperty float a\n"
        "element face 1\nproperty uchar flags\nproperty list uchar uint vertex_indices\n"
        "property list uchar float weights\n"
        "element nothing 4000000000\n"
        "element vertex 4\nproperty list int uchar tags\nproperty float x\nproperty float q\n"
        "property float y\nproperty float z\n"
        "element edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n"
        "2 0.5 0.25 7\n"
        "1 4 0 1 3 2 2 nan 0.5\n"
        "0 1 -9 2 3\n1 200 4 -9 5 6\n3 1 2 3 7 -9 8 9\n0 10 -9 11 12\n"
        "0 1\n";
    const Result<Mesh> mesh = read_text(text);
    ASSERT_TRUE(mesh) << mesh.error().detail;
    EXPECT_EQ(mesh->positions,
              (std::vector<Point3>{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {10, 11, 12}}));
    EXPECT_EQ(mesh->faces.indices, (std::vector<std::uint32_t>{0, 1, 3, 2}));
    EXPECT_EQ(mesh->faces.offsets, (std::vector<std::uint32_t>{0, 4}));
    EXPECT_EQ(mesh->notes.size(), 3U);  // of faces, of elements, of vertices
}

TEST(ReadPly, TrianglesBeforeAPolygonKeepTheirPlace)
{
    const auto mesh = read_text(
        ascii(xyz, {"0 0 0", "1 0 0", "0 1 0", "1 1 0"}, {"3 0 1 2", "3 1 3 2", "4 0 1 3 2"}));
    ASSERT_TRUE(mesh) << mesh.error().detail;
    EXPECT_EQ(mesh->faces.offsets, (std::vector<std::uint32_t>{0, 3, 6, 10}));
    EXPECT_EQ(mesh->faces.indices, (std::vector<std::uint32_t>{0, 1, 2, 1, 3, 2, 0, 1, 3, 2}));
}

TEST(ReadPly, WholeNumberColoursAreSrgbAndFloatsLinear)
{
    struct Case {
        const char* type;
        const char* values;
        double encoded;  // of the green channel
    };
    for (const Case& c : {Case{"uchar", "255 188 0", 188.0 / 255.0},
                          {"ushort", "65535 40000 0", 40000.0 / 65535.0}}) {
        for (const char* name : {"", "diffuse_"}) {
            std::string properties = xyz;
            for (const char* band : {"red", "green", "blue"}) {
                properties += std::string("property ") + c.type + " " + name + band + "\n";
            }
            const auto mesh = read_text(ascii(properties, {std::string("0 0 0 ") + c.values}));
            ASSERT_TRUE(mesh) << mesh.error().detail;
            const Rgbf expected = {1.0F, static_cast<float>(srgb_eotf(c.encoded)), 0.0F};
            EXPECT_EQ(mesh->colors.at(0), expected) << c.type;
        }
    }
    const auto mesh = read_text(ascii(
        xyz + "property float r\nproperty float g\nproperty float b\n", {"0 0 0 0.25 1.5 0"}));
    ASSERT_TRUE(mesh) << mesh.error().detail;
    EXPECT_EQ(mesh->colors.at(0), (Rgbf{0.25F, 1.5F, 0.0F}));
}

TEST(ReadPly, ColoursOfATypeWithoutAScaleAreLeftOutAndSaidSo)
{
    const auto mesh = read_text(
        ascii(xyz + "property int red\nproperty int green\nproperty int blue\n", {"0 0 0 1 2 3"}));
    ASSERT_TRUE(mesh) << mesh.error().detail;
    EXPECT_TRUE(mesh->colors.empty());
    EXPECT_NE(mesh->notes.at(0).find("colours left out"), std::string::npos);
}

TEST(ReadPly, TextureCoordinatesHaveFourNames)
{
    for (const auto& [u, v] : {std::pair{"s", "t"},
                               {"u", "v"},
                               {"texture_u", "texture_v"},
                               {"texture_s", "texture_t"}}) {
        const auto mesh = read_text(ascii(
            xyz + "property float " + v + "\nproperty float " + u + "\n", {"0 0 0 0.25 0.75"}));
        ASSERT_TRUE(mesh) << mesh.error().detail;
        EXPECT_EQ(mesh->uvs.at(0), (std::array{0.75F, 0.25F}));
    }
}

TEST(ReadPly, TexcoordListsBelongToCorners)
{
    const std::string lists =
        "property list uchar float texcoord\nproperty list uchar int vertex_indices\n";
    const auto mesh =
        read_text(ascii(xyz, corners, {"6 0 0.5 1 0.25 2 3 3 0 1 2", "0 3 2 1 0"}, lists));
    ASSERT_TRUE(mesh) << mesh.error().detail;
    const std::vector<std::array<float, 2>> expected = {{0, 0.5F}, {1, 0.25F}, {2, 3},
                                                        {0, 0},    {0, 0},     {0, 0}};
    EXPECT_EQ(mesh->corner_uvs, expected);

    const auto odd = read_text(ascii(xyz, corners, {"5 0 0 0 0 0 3 0 1 2"}, lists));
    ASSERT_FALSE(odd);
    EXPECT_EQ(odd.error().fault, Fault::MalformedBody);
}

TEST(ReadPly, NonFiniteNormalsAreNoneAndCounted)
{
    const auto mesh =
        read_text(ascii(xyz + "property float nx\nproperty float ny\nproperty float nz\n",
                        {"0 0 0 nan nan nan", "1 1 1 0 0 2"}));
    ASSERT_TRUE(mesh) << mesh.error().detail;
    EXPECT_EQ(mesh->normals, (std::vector<Vec3>{{0, 0, 0}, {0, 0, 2}}));
    EXPECT_EQ(mesh->notes.size(), 1U);
}

TEST(ReadPly, NanKeepsThePlaceOfAPointInACloud)
{
    for (const char* nan : {"nan", "-NaN", "NAN", "1.#QNAN", "-1.#IND"}) {
        const auto mesh = read_text(
            ascii(xyz, {"0 0 " + std::string(nan), "1 2 3", std::string(nan) + " inf 0", "4 5 6"}));
        ASSERT_TRUE(mesh) << mesh.error().detail;
        EXPECT_EQ(mesh->absent, (std::vector<std::uint32_t>{0, 2})) << nan;
        EXPECT_EQ(mesh->positions,
                  (std::vector<Point3>{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {4, 5, 6}}));
        EXPECT_TRUE(test::notes_say(*mesh, "2 points have NaN coordinates"));
    }
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    for (const bool big_endian : {false, true}) {
        std::string file = "ply\nformat binary_" + std::string(big_endian ? "big" : "little") +
                           "_endian 1.0\nelement vertex 3\n" + xyz + "end_header\n";
        for (const float c : {1.F, 2.F, 3.F, 4.F, nan, 6.F, 7.F, 8.F, 9.F}) {
            file += raw(c, big_endian);
        }
        const auto mesh = read_text(file);
        ASSERT_TRUE(mesh) << mesh.error().detail;
        EXPECT_EQ(mesh->absent, (std::vector<std::uint32_t>{1}));
        EXPECT_EQ(mesh->positions, (std::vector<Point3>{{1, 2, 3}, {1, 2, 3}, {7, 8, 9}}));
        EXPECT_EQ(test::broken_promise(*mesh, file.size()), "");
    }
}

TEST(ReadPly, NanIsRefusedAmongFacesAndInfinityAlways)
{
    const auto fault = [](const std::string& point, const std::vector<std::string>& faces) {
        const auto mesh = read_text(ascii(xyz, {"0 0 0", "1 0 0", "0 1 0", point}, faces));
        return mesh ? "none" : std::string(fault_code(mesh.error().fault));
    };
    EXPECT_EQ(fault("nan 0 0", {}), "none");
    EXPECT_EQ(fault("nan 0 0", {"3 0 1 2"}), "non_finite_coordinate");
    for (const char* point : {"inf 0 0", "0 -inf 0", "0 0 1.#INF"}) {
        EXPECT_EQ(fault(point, {}), "non_finite_coordinate") << point;
    }
    EXPECT_EQ(fault("0 1e16 0", {}), "coordinate_too_large");
    const auto none = read_text(ascii(xyz, {"nan nan nan", "0 0 nan"}));
    ASSERT_FALSE(none);
    EXPECT_EQ(none.error().fault, Fault::NoGeometry);
}

TEST(ReadPly, PositionsAreDoubleOnlyWhereFloatWouldLose)
{
    const std::string xyz64 = "property double x\nproperty double y\nproperty double z\n";
    const std::string xyz_int = "property int x\nproperty int y\nproperty int z\n";
    const auto is_double = [](const std::string& properties, const std::vector<std::string>& v) {
        const Result<Mesh> mesh = read_text(ascii(properties, v));
        return mesh && mesh->double_positions;
    };
    EXPECT_FALSE(is_double(xyz, {"0.1 0.2 0.3", "5 6 7"}));  // rounds by less than 1e-7 of its size
    EXPECT_TRUE(is_double(xyz, {"5000000.1 0 0", "5000000.2 0 0"}));  // a map: float would merge
    EXPECT_TRUE(is_double(xyz64, {"0.1 0 0", "5 6 7"}));
    EXPECT_FALSE(is_double(xyz64, {"0.5 0 0", "5 6 7"}));
    EXPECT_TRUE(is_double(xyz_int, {"16777217 0 0"}));
    EXPECT_FALSE(is_double(xyz_int, {"16777216 0 0"}));
}

TEST(ReadPly, EachKindOfDamageHasItsFault)
{
    const auto fault = [](const std::string& text) -> std::string {
        const Result<Mesh> mesh = read_text(text);
        return mesh ? "read" : std::string(fault_code(mesh.error().fault));
    };
    const auto faces = [&](const std::vector<std::string>& lines) {
        return fault(ascii(xyz, corners, lines));
    };
    EXPECT_EQ(faces({"3 0 1 2"}), "read");
    EXPECT_EQ(faces({"2 0 1"}), "count_exceeds_file");  // three corners need more bytes than that
    EXPECT_EQ(faces({"2 0 1    "}), "malformed_body");
    EXPECT_EQ(faces({"3 0 1 2 2"}), "malformed_body");
    EXPECT_EQ(faces({"3 0 1 2 3 0 1 2"}), "malformed_body");
    EXPECT_EQ(faces({"3 0 1 2", "3 0 1"}), "count_exceeds_file");
    EXPECT_EQ(faces({"3   0   1"}), "truncated");
    EXPECT_EQ(faces({"3 0 1 1.5"}), "malformed_body");
    EXPECT_EQ(faces({"3 0 1 2147483648"}), "malformed_body");  // not an int
    EXPECT_EQ(faces({"300 0 1 2"}), "malformed_body");         // not a uchar
    EXPECT_EQ(faces({"3 0 1 3"}), "index_out_of_range");
    EXPECT_EQ(fault(ascii(xyz, {"0 0 0", "1 0", "0 1 0 5"})), "malformed_body");
    EXPECT_EQ(fault(ascii(xyz, {"0 0 0x"})), "malformed_body");
    EXPECT_EQ(fault(ascii(xyz, {"0 0 1e400"})), "coordinate_too_large");
    EXPECT_EQ(fault(ascii(xyz, {"0 0 1.0001e15"})), "coordinate_too_large");
    EXPECT_EQ(fault(ascii(xyz, {"0 0 -1e15"})), "read");
    EXPECT_EQ(fault(ascii(xyz, {"0 0 -inf"})), "non_finite_coordinate");
    EXPECT_EQ(fault(ascii(xyz, {})), "no_geometry");
    EXPECT_EQ(fault(ascii(xyz + "property float x\n", {"0 0 0 0"})), "malformed_header");
    EXPECT_EQ(fault(ascii("property list uchar float x\nproperty float y\nproperty float z\n",
                          {"1 0 0 0"})),
              "malformed_header");
    EXPECT_EQ(fault(ascii(xyz, corners, {"3 0 1 2"}, "property list uchar float vertex_index\n")),
              "malformed_header");
    EXPECT_EQ(fault(ascii(xyz, corners, {"3 0 1 2"}, "property list float int vertex_index\n")),
              "malformed_header");
    EXPECT_EQ(fault(ascii(xyz, corners, {"3 0 1 2"}, "property int vertex_index\n")),
              "malformed_header");
    EXPECT_EQ(fault(ascii(xyz, corners, {"-3 0 1 2"}, "property list int int vertex_index\n")),
              "malformed_body");
    EXPECT_EQ(fault(ascii(xyz + "element vertex 3\n", corners)), "malformed_header");
    EXPECT_EQ(fault("ply\nformat ascii 1.0\nformat ascii 1.0\nend_header\n"), "malformed_header");
    EXPECT_EQ(fault("ply\nformat ascii 2.0\nend_header\n"), "malformed_header");
    EXPECT_EQ(fault("ply\nformat ascii 1.0\nend_header\n"), "malformed_header");
    EXPECT_EQ(fault("ply\nformat ascii 1.0\nelement vertex 1\n" + xyz +
                    "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
                    "0 0 0\n3 0 0 0\n"),
              "malformed_header");
}

// The lists are longer than the least that the counts were checked with, and eat what is left.
TEST(ReadPly, BodiesThatEndInsideARecordAreTruncated)
{
    const std::string vertex =
        "element vertex 1\nproperty uchar x\nproperty uchar y\nproperty uchar z\n";
    const std::string tagged =
        "element vertex 2\nproperty list uchar uchar tags\n"
        "property uchar x\nproperty uchar y\nproperty uchar z\n";
    const auto faces = [](const std::string& count) {
        return "element face " + count + "\nproperty list uchar uchar vertex_index\n";
    };
    for (const std::string encoding : {"binary_little_endian", "binary_big_endian"}) {
        const auto expect_truncated = [&](const std::string& elements, const std::string& body,
                                          std::size_t whole) {
            std::string header = "ply\nformat ";
            header.append(encoding).append(" 1.0\n").append(elements).append("end_header\n");
            const std::string text = header + body;
            const std::vector<char> exact(text.begin(), text.end());  // for AddressSanitizer
            const Result<Mesh> mesh = read_text({exact.data(), exact.size()});
            ASSERT_FALSE(mesh) << elements;
            EXPECT_EQ(fault_code(mesh.error().fault), "truncated") << elements;
            EXPECT_EQ(mesh.error().byte, header.size() + whole) << elements;
        };
        expect_truncated(faces("1") + vertex, "\6" + std::string(6, '\0'), 7);
        expect_truncated(vertex + faces("2"), std::string(3, '\0') + "\7" + std::string(7, '\0'),
                         11);
        expect_truncated(tagged, "\3" + std::string(7, '\0'), 7);
    }
}

TEST(ReadPly, OnlyBlanksMayFollowTheBody)
{
    for (const char* encoding : {"binary_little_endian", "binary_big_endian"}) {
        const std::string text = triangle_of<float>("float", encoding);
        EXPECT_TRUE(read_text(text + "\n"));
        EXPECT_TRUE(read_text(text + " \r\n"));
        const Result<Mesh> more = read_text(text + "\n\x01");
        ASSERT_FALSE(more);
        EXPECT_EQ(more.error().fault, Fault::MalformedBody);
        EXPECT_EQ(more.error().byte, text.size());
    }
    EXPECT_TRUE(read_text(ascii(xyz, corners, {"3 0 1 2"}) + "\n\n  "));
    const Result<Mesh> more = read_text(ascii(xyz, corners, {"3 0 1 2"}) + "\n3 0 1 2\n");
    ASSERT_FALSE(more);
    EXPECT_EQ(more.error().fault, Fault::MalformedBody);
    EXPECT_EQ(more.error().line, 15U);
}

TEST(ReadPly, AHeaderWithoutEndIsNotReadOnAndOn)
{
    const std::string text = "ply\nformat ascii 1.0\n" + std::string(3'000'000, '\n');
    const Result<Mesh> mesh = read_text(text);
    ASSERT_FALSE(mesh);
    EXPECT_EQ(mesh.error().fault, Fault::MalformedHeader);
    EXPECT_NE(mesh.error().detail.find("first MiB"), std::string::npos);
}

TEST(ReadPly, MoreThanTheLimitsIsRefusedAndSaysThem)
{
    const std::string text = ascii(xyz, corners, {"3 0 1 2", "3 2 1 0"});
    EXPECT_TRUE(read(read_ply, text, {3, 2}));
    const Result<Mesh> vertices = read(read_ply, text, {2, 2});
    ASSERT_FALSE(vertices);
    EXPECT_EQ(vertices.error().fault, Fault::TooManyVertices);
    EXPECT_EQ(vertices.error().detail, "3 vertices; the limit is 2");
    const Result<Mesh> faces = read(read_ply, text, {3, 1});
    ASSERT_FALSE(faces);
    EXPECT_EQ(faces.error().fault, Fault::TooManyFaces);
}

TEST(ReadPly, StopsWhenAsked)
{
    for (const char* encoding : {"ascii", "binary_little_endian", "binary_big_endian"}) {
        const std::string text = triangle_of<float>("float", encoding);
        Progress progress;
        progress.stop();
        const Result<Mesh> mesh = read_ply(std::as_bytes(std::span(text)), {}, progress);
        ASSERT_FALSE(mesh);
        EXPECT_EQ(mesh.error().fault, Fault::Cancelled);
    }
}

}  // namespace
}  // namespace relight
