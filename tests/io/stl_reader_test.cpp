#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstring>
#include <limits>

#include "tests/io/reader_checks.h"

namespace relight::test {
namespace {

const std::string data = RELIGHT_TEST_DATA;

Result<Mesh> stl(std::string_view text, const ReadLimits& limits = {})
{
    return read(read_stl, text, limits);
}

/// Normal, then three corners.
using Facet = std::array<float, 12>;
constexpr Facet up{0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0};
constexpr Facet tilted{0, 0, 0, 1, 2, 3, 4, -5, 6, 7, 8, 9.5F};

template <class T>
std::string bytes(const T& value)
{
    std::string out(sizeof(T), '\0');
    std::memcpy(out.data(), &value, sizeof(T));
    return out;
}

std::string binary(const std::vector<Facet>& facets, std::uint32_t count, std::string head = "")
{
    head.resize(80, '\0');
    std::string out = head + bytes(count);
    for (const Facet& f : facets) { out += bytes(f) + "\x12\x34"; }
    return out;
}

std::string ascii(const std::vector<Facet>& facets)
{
    std::string out = "solid name of it\n";
    for (const Facet& f : facets) {
        const auto three = [&](std::size_t i) {
            return ' ' + std::to_string(f[i]) + ' ' + std::to_string(f[i + 1]) + ' ' +
                   std::to_string(f[i + 2]) + '\n';
        };
        out += "facet normal" + three(0) + "outer loop\nvertex" + three(3) + "vertex" + three(6) +
               "vertex" + three(9) + "endloop\nendfacet\n";
    }
    return out + "endsolid name of it\n";
}

TEST(StlReader, ReadsEverySampleWithTheCountsOfItsSource)  // tests/data/meshes, counted by others
{
    struct Row {
        const char* file;
        std::size_t vertices, faces;
    };
    for (const Row& row :
         {Row{"spider_binary.stl", 4104, 1368}, Row{"sphereWithHole.stl", 855, 285},
          Row{"triangle_with_two_solids.stl", 6, 2}, Row{"icosahedron_ascii.stl", 60, 20},
          Row{"soup.stl", 300, 100}, Row{"featuretype.STL", 10428, 3476}}) {
        const std::string file = contents(data + "/meshes/" + row.file);
        const Result<Mesh> mesh = stl(file);
        ASSERT_TRUE(mesh) << row.file << ": " << mesh.error().detail;
        EXPECT_EQ(mesh->positions.size(), row.vertices) << row.file;
        EXPECT_EQ(mesh->faces.count(), row.faces) << row.file;
        EXPECT_EQ(broken_promise(*mesh, file.size()), "") << row.file;
        EXPECT_EQ(mesh->format, "stl");
        EXPECT_TRUE(mesh->normals.empty());
    }
}

TEST(StlReader, KeepsThreeVerticesOfItsOwnForEachFacet)
{
    const Result<Mesh> mesh = stl(contents(data + "/meshes/triangle_with_two_solids.stl"));
    ASSERT_TRUE(mesh);
    EXPECT_EQ(
        mesh->positions,
        (std::vector<Point3>{{1, 1, 0}, {-1, 1, 0}, {0, -1, 0}, {3, 3, 0}, {2, 3, 0}, {0, 2, 0}}));
    EXPECT_EQ(mesh->faces.indices, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5}));
    EXPECT_TRUE(mesh->faces.offsets.empty());
}

TEST(StlReader, ReadsTheSameFromTextAndFromBytes)
{
    const std::vector<Facet> facets{up, tilted, up};
    const Result<Mesh> text = stl(ascii(facets));
    const Result<Mesh> packed = stl(binary(facets, 3));
    ASSERT_TRUE(text) << text.error().detail;
    ASSERT_TRUE(packed) << packed.error().detail;
    EXPECT_TRUE(same(*text, *packed));
    EXPECT_EQ(text->positions[5], (Point3{7, 8, 9.5}));
    EXPECT_TRUE(text->notes.empty());
    const Result<Mesh> solid = stl(binary(facets, 3, "solid but binary all the same"));
    ASSERT_TRUE(solid) << solid.error().detail;
    EXPECT_TRUE(same(*solid, *packed));
}

TEST(StlReader, ReadsTextOfAnyCaseAndSpacing)
{
    const Result<Mesh> reference = stl(binary({up}, 1));
    ASSERT_TRUE(reference);
    for (const char* text :
         {"\xEF\xBB\xBF  SOLID\r\nFACET NORMAL 0 0 1\r\nOUTER LOOP\r\nVERTEX 0 0 0\r\nVERTEX 1 0 "
          "0\r\nVERTEX 0 1 0\r\nENDLOOP\r\nENDFACET\r\nENDSOLID",
          "solid\rfacet\tnormal 0\n0 +1.e0 outer\n\nloop vertex 0 0 0 vertex 1. 0 0 vertex 0 1 0 "
          "endloop endfacet endsolid x facet",
          "Solid a\nendsolid a\nsolid facet normal\nfacet normal 0 0 0 outer loop vertex 0 0 0 "
          "vertex 1 0 0 vertex 0 1 0 endloop endfacet\nendsolid",
          "solid\nfacet normal nan -nan(ind) inf outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 "
          "endloop endfacet\nendsolid"}) {
        const Result<Mesh> mesh = stl(text);
        ASSERT_TRUE(mesh) << text << mesh.error().detail;
        EXPECT_TRUE(same(*mesh, *reference)) << text;
        EXPECT_TRUE(mesh->notes.empty()) << text;
    }
}

TEST(StlReader, CountsFiledNormalsThatContradictTheWinding)
{
    Facet down = up, slanted = up, broken = up;
    down[2] = -1;
    slanted[1] = 1;  // 45 degrees off: rounded, not wrong
    broken[0] = std::numeric_limits<float>::quiet_NaN();
    const Result<Mesh> mesh = stl(binary({up, down, slanted, down, tilted, broken}, 6));
    ASSERT_TRUE(mesh) << mesh.error().detail;
    ASSERT_EQ(mesh->notes.size(), 1U);
    EXPECT_EQ(mesh->notes[0].substr(0, 30), "2 facet normals disagree with ");
    EXPECT_TRUE(mesh->normals.empty()) << "the winding decides";
}

void expect_refused(std::string_view text, Fault fault, std::uint64_t line, std::uint64_t byte)
{
    const Result<Mesh> mesh = stl(text);
    ASSERT_FALSE(mesh) << text;
    EXPECT_EQ(fault_code(mesh.error().fault), fault_code(fault)) << text << mesh.error().detail;
    EXPECT_EQ(mesh.error().line.value_or(0), line) << text << mesh.error().detail;
    EXPECT_EQ(mesh.error().byte.value_or(0), byte) << mesh.error().detail;
}

TEST(StlReader, RefusesBrokenBinaryFilesAtTheirByte)
{
    const auto broken = [](const char* name) { return contents(data + "/broken/" + name); };
    expect_refused(broken("a_stl_4g_facets.stl"), Fault::CountExceedsFile, 0, 80);
    expect_refused(broken("a_stl_wrong_count.stl"), Fault::CountExceedsFile, 0, 80);
    expect_refused(broken("trimesh_stl_empty_bin.stl"), Fault::NoGeometry, 0, 0);
    expect_refused(binary({up, up}, 1), Fault::MalformedBody, 0, 134);
    expect_refused(binary({up}, 1) + "\n", Fault::MalformedBody, 0, 134);
    expect_refused(binary({}, 1).substr(0, 83), Fault::Truncated, 0, 83);
    expect_refused(binary({up}, 1, "solid cut short").substr(0, 120), Fault::CountExceedsFile, 0,
                   80);
    Facet far = up;
    far[11] = -2e15F;
    expect_refused(binary({up, far}, 2), Fault::CoordinateTooLarge, 0, 84 + 50 + 44);
    far[3] = -std::numeric_limits<float>::infinity();
    expect_refused(binary({up, far}, 2), Fault::NonFiniteCoordinate, 0, 84 + 50 + 12);
}

TEST(StlReader, RefusesBrokenTextAtItsLine)
{
    const std::string begin = "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n";
    const std::string end = "endloop\nendfacet\nendsolid\n";
    ASSERT_TRUE(stl(begin + "vertex 0 1 0\n" + end));
    expect_refused("", Fault::EmptyFile, 0, 0);
    expect_refused("hello\n", Fault::MalformedBody, 1, 0);
    expect_refused("solid\nendsolid\n", Fault::NoGeometry, 0, 0);
    expect_refused("solid\nsolid\n", Fault::MalformedBody, 2, 0);
    expect_refused("solid\nendsolid\nfacet", Fault::MalformedBody, 3, 0);
    expect_refused("solid\nface normal", Fault::MalformedBody, 2, 0);
    expect_refused(begin + end, Fault::MalformedBody, 6, 0);
    expect_refused(begin + "vertex 0 1 0\nvertex 1 1 0\n" + end, Fault::MalformedBody, 7, 0);
    expect_refused(begin + "vertex 0 1\n" + end, Fault::MalformedBody, 7, 0);
    expect_refused(begin + "vertex 0 1 nan\n" + end, Fault::NonFiniteCoordinate, 6, 0);
    expect_refused(begin + "vertex 0 1 1e16\n" + end, Fault::CoordinateTooLarge, 6, 0);
    expect_refused(begin + "vertex 0 1 0\nendloop\nendfacet\n", Fault::Truncated, 9, 0);
    expect_refused(begin, Fault::Truncated, 6, 0);
    expect_refused("solid\nfacet normal 0 0 x", Fault::MalformedBody, 2, 0);
}

TEST(StlReader, KeepsDoublesWhereFloatWouldLoseThem)
{
    const std::string text =
        "solid\nfacet normal 0 0 1 outer loop vertex 4500000.125 0 0 vertex 4500001.5 0 0 vertex "
        "4500000 1.5 0 endloop endfacet\nendsolid";
    const Result<Mesh> mesh = stl(text);
    ASSERT_TRUE(mesh);
    EXPECT_TRUE(mesh->double_positions);
    EXPECT_EQ(mesh->positions[0].x, 4500000.125);
}

TEST(StlReader, HoldsToItsLimitsAndStopsWhenTold)
{
    for (const std::string& two : {ascii({up, up}), binary({up, up}, 2)}) {
        ASSERT_TRUE(stl(two, {6, 2}));
        EXPECT_EQ(stl(two, {5, 2}).error().fault, Fault::TooManyVertices);
        EXPECT_EQ(stl(two, {6, 1}).error().fault, Fault::TooManyFaces);
        Progress progress;
        progress.stop();
        EXPECT_EQ(read_stl(std::as_bytes(std::span(two)), {}, progress).error().fault,
                  Fault::Cancelled);
    }
}

TEST(StlReader, KeepsItsPromisesOnBrokenFiles)
{
    EXPECT_EQ(broken_promise_of_mutants(
                  read_stl, contents(data + "/meshes/triangle_with_two_solids.stl"), 4000, 1),
              "");
    EXPECT_EQ(broken_promise_of_mutants(read_stl, binary({up, tilted, up}, 3), 6000, 2), "");
    std::mt19937 random(3);  // bits of the right length
    for (int i = 0; i < 2000; ++i) {
        std::vector<Facet> facets(1 + random() % 4);
        for (Facet& f : facets) {
            for (float& x : f) {
                x = std::bit_cast<float>(static_cast<std::uint32_t>(random() & random()));
            }
        }
        ASSERT_EQ(
            broken_promise(read_stl, binary(facets, static_cast<std::uint32_t>(facets.size()))),
            "");
    }
}

}  // namespace
}  // namespace relight::test
