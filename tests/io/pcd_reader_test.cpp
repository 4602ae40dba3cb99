#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "core/display/display.h"
#include "core/io/lzf.h"
#include "tests/io/cloud_checks.h"

namespace relight::test {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float inf = std::numeric_limits<float>::infinity();

Result<Mesh> pcd(std::string_view file)
{
    return read(read_pcd, file);
}

/// LZF as its writers make it: the longest earlier match of three bytes or more, else literals.
std::string lzf(std::string_view text)
{
    std::string out, literals;
    const auto flush = [&] {
        for (std::size_t i = 0; i < literals.size(); i += 32) {
            const std::string part = literals.substr(i, 32);
            out += static_cast<char>(part.size() - 1);
            out += part;
        }
        literals.clear();
    };
    for (std::size_t at = 0; at < text.size();) {
        std::size_t longest = 0, back = 0;
        for (std::size_t b = 1; b <= std::min<std::size_t>(at, 8192); ++b) {
            std::size_t n = 0;
            while (n < 264 && at + n < text.size() && text[at + n] == text[at + n - b]) { ++n; }
            if (n > longest) {
                longest = n;
                back = b;
            }
        }
        if (longest < 3) {
            literals += text[at++];
            continue;
        }
        flush();
        const std::size_t length = longest - 2, offset = back - 1;
        out += static_cast<char>(std::min<std::size_t>(length, 7) << 5 | offset >> 8);
        if (length >= 7) { out += static_cast<char>(length - 7); }
        out += static_cast<char>(offset & 255);
        at += longest;
    }
    flush();
    return out;
}

std::optional<std::string> unpacked(std::string_view packed, std::size_t size)
{
    const auto bytes = unpack_lzf(std::as_bytes(std::span(packed)), size);
    if (!bytes) { return {}; }
    return std::string(reinterpret_cast<const char*>(bytes->data()), bytes->size());
}

TEST(Lzf, UnpacksWhatWasPacked)
{
    std::mt19937 random(1);
    for (const unsigned letters : {1U, 2U, 5U, 256U}) {
        for (const std::size_t size : {0U, 1U, 31U, 32U, 33U, 300U, 9000U}) {
            std::string text;
            while (text.size() < size) { text += static_cast<char>(random() % letters); }
            EXPECT_EQ(unpacked(lzf(text), size), text) << letters << " letters, " << size;
        }
    }
    EXPECT_EQ(unpacked(std::string("\2abc\x80\2", 6), 9), "abcabcabc") << "overlapping";
    EXPECT_EQ(unpacked(std::string("\0a\xE0\xFF\0", 5), 265), std::string(265, 'a')) << "longest";
}

TEST(Lzf, RefusesWhatDoesNotGiveTheAnnouncedSize)
{
    EXPECT_FALSE(unpacked("\2abc", 2));
    EXPECT_FALSE(unpacked("\2abc", 4));
    EXPECT_FALSE(unpacked("\2ab", 3)) << "literals beyond the end";
    EXPECT_FALSE(unpacked(std::string("\0a\x20", 3), 4)) << "no offset";
    EXPECT_FALSE(unpacked(std::string("\0a\xE0\1", 4), 11)) << "no offset after a long length";
    EXPECT_FALSE(unpacked(std::string("\0a\x20\1", 4), 4)) << "back before the start";
    EXPECT_FALSE(unpacked(std::string("\x20\0", 2), 3)) << "back before the start";
    EXPECT_FALSE(unpacked("", 1));
    EXPECT_FALSE(unpacked("\2abc", std::size_t{1} << 60)) << "allocated before it is believed";
}

struct Point {
    float x, y, z;
    std::uint32_t rgb;
    float nx, ny, nz;
};
constexpr std::size_t count = 6;
constexpr std::array<Point, count> points = {{{1.5F, -2, .1F, 0xFFC80A00, 0, 0, 1},
                                              {nan, nan, nan, 0xFF000000, nan, nan, nan},
                                              {4, 5, 6, 0x000000FF, nan, 0, 0},
                                              {4, 5, nan, 0xFF112233, 0, 1, 0},
                                              {-7, 8e6F, 9, 0xFFFFFFFF, 0, -2, 0},
                                              {0, 0, 0, 0, 0, 0, 0}}};

/// Fields of four bytes, with padding of two bytes and three numbers of `spin` among them.
std::string header(std::string_view data, std::string_view rgb = "rgb", char type = 'F')
{
    return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z _ " +
           std::string(rgb) +
           " spin normal_x normal_y normal_z\nSIZE 4 4 4 1 4 2 4 4 4\nTYPE F F F U " + type +
           " I F F F\nCOUNT 1 1 1 2 1 3 1 1 1\nWIDTH 3\nHEIGHT 2\n" +
           "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 6\nDATA " + std::string(data) + "\n";
}

std::string ascii()
{
    std::string file = header("ascii", "rgba", 'U');
    for (const Point& p : points) {
        const auto add = [&](float v) {
            std::array<char, 40> text{};
            std::snprintf(text.data(), text.size(), "%.9g ", static_cast<double>(v));
            file += text.data();
        };
        for (const float v : {p.x, p.y, p.z}) { add(v); }
        file += "0 0 " + std::to_string(p.rgb) + " -1 2 3 ";
        for (const float v : {p.nx, p.ny, p.nz}) { add(v); }
        file += "\n";
    }
    return file;
}

/// The parts of a point in the file's order.
std::array<std::string, 9> parts(const Point& p)
{
    std::array<std::string, 9> out;
    append_bytes(out[0], p.x);
    append_bytes(out[1], p.y);
    append_bytes(out[2], p.z);
    out[3] = "\1\2";
    append_bytes(out[4], p.rgb);
    out[5] = "spin!!";
    append_bytes(out[6], p.nx);
    append_bytes(out[7], p.ny);
    append_bytes(out[8], p.nz);
    return out;
}

std::string binary()
{
    std::string file = header("binary");
    for (const Point& p : points) {
        for (const std::string& part : parts(p)) { file += part; }
    }
    return file;
}

std::string by_field()
{
    std::string body;
    for (std::size_t field = 0; field < 9; ++field) {
        for (const Point& p : points) { body += parts(p)[field]; }
    }
    return body;
}

std::string compressed(const std::string& body = by_field())
{
    const std::string packed = lzf(body);
    std::string file = header("binary_compressed", "rgba", 'U');
    append_bytes(file, static_cast<std::uint32_t>(packed.size()));
    append_bytes(file, static_cast<std::uint32_t>(body.size()));
    return file + packed;
}

TEST(PcdReader, ReadsEverySampleWithTheCountOfItsSource)
{
    struct Row {
        const char* file;
        std::size_t points, absent;
        bool colors, normals;
    };
    // NaN points of the scan counted by a decoder written apart from this one.
    for (const Row& row :
         {Row{"bun0.pcd", 397, 0, false, true}, Row{"milk_color.pcd", 13704, 0, true, false},
          Row{"colored_cloud.pcd", 1000, 0, true, true},
          Row{"table_scene_mug_stereo_textured.pcd", 307200, 97920, true, false},
          Row{"lamppost.pcd", 1771, 0, false, false},
          Row{"utm17_space.pcd", 10, 0, false, false}}) {
        const std::string file = cloud(row.file);
        const Result<Mesh> mesh = pcd(file);
        ASSERT_TRUE(mesh) << row.file << ": " << mesh.error().detail;
        EXPECT_EQ(broken_promise(*mesh, file.size()), "") << row.file;
        EXPECT_EQ(mesh->format, "pcd");
        EXPECT_EQ(mesh->positions.size(), row.points) << row.file;
        EXPECT_EQ(mesh->absent.size(), row.absent) << row.file;
        EXPECT_EQ(!mesh->colors.empty(), row.colors) << row.file;
        EXPECT_EQ(!mesh->normals.empty(), row.normals) << row.file;
    }
}

TEST(PcdReader, ReadsTheSamePointsAsThePlyConvertedFromThem)
{
    const Result<Mesh> ours = pcd(cloud("colored_cloud.pcd"));
    const Result<Mesh> ply = read(read_ply, cloud("colored_cloud_converted.ply"));
    ASSERT_TRUE(ours && ply);
    EXPECT_EQ(ours->positions, ply->positions);
    EXPECT_EQ(ours->colors, ply->colors);
    EXPECT_EQ(ours->normals, ply->normals);
    const Result<Mesh> milk = pcd(cloud("milk_color.pcd"));
    const Result<Mesh> text = read(read_ply, cloud("milk_color_converted_ascii.ply"));
    ASSERT_TRUE(milk && text);
    EXPECT_EQ(milk->colors, text->colors);
    for (std::size_t i = 0; i < milk->positions.size(); ++i) {
        ASSERT_LT(length(milk->positions[i] - text->positions[i]), 1e-5) << i;  // six digits
    }
}

TEST(PcdReader, EveryEncodingHoldsTheSamePoints)
{
    const Result<Mesh> mesh = pcd(binary());
    ASSERT_TRUE(mesh) << mesh.error().detail;
    EXPECT_EQ(mesh->positions[0], (Point3{1.5, -2, double{.1F}}));
    EXPECT_EQ(mesh->colors[0], to_float(srgb_eotf(Rgb8{200, 10, 0})));
    EXPECT_EQ(mesh->colors[2], to_float(srgb_eotf(Rgb8{0, 0, 255})));
    EXPECT_EQ(mesh->normals[4], (Vec3{0, -2, 0}));
    EXPECT_FALSE(mesh->double_positions);
    EXPECT_TRUE(notes_say(*mesh, "fields left out: 'spin'")) << "and not the padding";
    for (const std::string& file : {ascii(), compressed(), binary() + std::string(99, '\0')}) {
        const Result<Mesh> other = pcd(file);
        ASSERT_TRUE(other) << other.error().detail;
        EXPECT_EQ(other->colors, mesh->colors);
        EXPECT_EQ(other->normals, mesh->normals);
        ASSERT_EQ(other->positions.size(), count);
        for (std::size_t i = 0; i < count; ++i) {  // text says 0.1F by nine digits
            EXPECT_NEAR(length(other->positions[i] - mesh->positions[i]), 0.0, 1e-9) << i;
        }
        EXPECT_EQ(other->absent, mesh->absent);
        EXPECT_FALSE(other->double_positions);
    }
}

TEST(PcdReader, KeepsThePlacesOfNanPoints)
{
    const Result<Mesh> mesh = pcd(binary());
    ASSERT_TRUE(mesh);
    EXPECT_EQ(mesh->absent, (std::vector<std::uint32_t>{1, 3})) << "3 has but one NaN";
    EXPECT_EQ(mesh->positions[1], mesh->positions[0]);
    EXPECT_EQ(mesh->positions[3], mesh->positions[0]);
    EXPECT_EQ(mesh->normals[1], Vec3{});
    EXPECT_EQ(mesh->normals[2], Vec3{}) << "a NaN normal is none";
    EXPECT_TRUE(notes_say(*mesh, "2 points"));
    EXPECT_TRUE(notes_say(*mesh, "1 normals"));
}

/// x y z alone, as bytes.
std::string plain(std::string_view viewpoint, std::initializer_list<Vec3> xyz)
{
    const std::string n = std::to_string(xyz.size());
    std::string file = "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH " + n +
                       "\nHEIGHT 1\n" + std::string(viewpoint) + "DATA binary\n";
    for (const Vec3& p : xyz) {
        for (const double c : {p.x, p.y, p.z}) { append_bytes(file, static_cast<float>(c)); }
    }
    return file;
}

TEST(PcdReader, TheFirstPresentPointNeedNotBeTheFirst)
{
    const Vec3 none = {double{nan}, 0, 0};
    const Result<Mesh> mesh = pcd(plain("", {none, none, {7, 8, 9}, none}));
    ASSERT_TRUE(mesh);
    EXPECT_EQ(mesh->absent, (std::vector<std::uint32_t>{0, 1, 3}));
    EXPECT_EQ(mesh->positions, std::vector<Point3>(4, {7, 8, 9}));
}

TEST(PcdReader, TheViewpointIsOneThatIsToldOrLiesOutside)
{
    const auto viewpoint = [](std::string_view line, std::initializer_list<Vec3> xyz) {
        const Result<Mesh> mesh = pcd(plain(line, xyz));
        EXPECT_TRUE(mesh) << mesh.error().detail;
        return mesh ? mesh->viewpoint : std::nullopt;
    };
    const std::string_view origin = "VIEWPOINT 0 0 0 1 0 0 0\n";
    const Vec3 none = {0, double{nan}, 0};
    EXPECT_EQ(viewpoint("VIEWPOINT 1 2 3 1 0 0 0\n", {{-9, -9, -9}, {9, 9, 9}}), (Point3{1, 2, 3}));
    EXPECT_EQ(viewpoint(origin, {{-9, -9, -9}, {9, 9, 9}}), std::nullopt);
    EXPECT_EQ(viewpoint(origin, {{-9, -9, 1}, {9, 9, 9}}), Point3{}) << "a scanner's frame";
    EXPECT_EQ(viewpoint(origin, {{-9, -9, 1}, none, {9, 9, 9}}), Point3{}) << "NaN widens nothing";
    EXPECT_EQ(viewpoint(origin, {{0, 0, 0}}), std::nullopt);
    EXPECT_EQ(viewpoint("", {{-9, -9, 1}, {9, 9, 9}}), std::nullopt) << "nothing said";
}

TEST(PcdReader, ReadsNumbersOfEveryType)
{
    std::string file =
        "VERSION 0.5\nFIELDS X Y Z\nSIZE 8 8 2\nTYPE F I U\nWIDTH 1\nHEIGHT 1\nDATA binary\n";
    append_bytes(file, 0.1);
    append_bytes(file, std::int64_t{-12});
    append_bytes(file, std::uint16_t{65535});
    const Result<Mesh> mesh = pcd(file);
    ASSERT_TRUE(mesh) << mesh.error().detail;
    EXPECT_EQ(mesh->positions[0], (Point3{0.1, -12, 65535}));
    EXPECT_TRUE(mesh->double_positions);
}

TEST(PcdReader, TextKeepsMoreDigitsThanItsDeclaredFloats)
{
    const Result<Mesh> mesh = pcd(cloud("utm17_space.pcd"));
    ASSERT_TRUE(mesh);
    EXPECT_EQ(mesh->positions[0], (Point3{289814.15, 4320978.61, 170.76}));
    EXPECT_TRUE(mesh->double_positions);
}

TEST(PcdReader, UnpacksAColourWrittenAsTheValueOfAFloat)  // as in PCL's tutorials
{
    const std::string head =
        "VERSION .7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F F\nWIDTH 2\nHEIGHT 1\nDATA ascii\n";
    const Result<Mesh> mesh = pcd(head + "0 1 2 2.3418052e-38\n0 1 2 nan\n");
    ASSERT_TRUE(mesh) << mesh.error().detail;
    ASSERT_EQ(std::bit_cast<std::uint32_t>(2.3418052e-38F), 0xFF0000U) << "a denormal number";
    EXPECT_EQ(mesh->colors[0], (Rgbf{1, 0, 0}));
    EXPECT_EQ(mesh->colors[1], (Rgbf{0, 0, 0}));
    EXPECT_TRUE(notes_say(*mesh, "not finite"));
}

/// `file` with the first `from` replaced.
std::string with(std::string file, std::string_view from, std::string_view to)
{
    const std::size_t at = file.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return file.replace(at, from.size(), to);
}

TEST(PcdReader, RefusesBrokenHeadersAtTheirLine)
{
    const std::string good =
        "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\n"
        "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 1\nDATA ascii\n1 2 3\n";
    ASSERT_TRUE(pcd(good));
    using enum Fault;
    const Refusal rows[] = {
        {"", EmptyFile, -1, -1, "no bytes"},
        {broken("a_pcd_width_times_height_overflow.pcd"), CountExceedsFile, 10, -1, "any file"},
        {broken("pdal_missingheader.pcd"), MalformedHeader, 1, -1, "'289814.15' begins no line"},
        {"VERSION 0.7\n", MalformedHeader, 2, -1, "there is no such line"},
        {with(good, "VERSION 0.7\n", ""), MalformedHeader, 9, -1, "before any line VERSION"},
        {with(good, "SIZE 4 4 4\n", ""), MalformedHeader, 9, -1, "before any line SIZE"},
        {with(good, "HEIGHT 1\n", "HEIGHT 1\nHEIGHT 1\n"), MalformedHeader, 8, -1, "second line"},
        {with(good, "0.7", "0.8"), MalformedHeader, 1, -1, "'0.8' is not read"},
        {with(good, "HEIGHT 1", "HEIGHT 1 1"), MalformedHeader, 7, -1,
         "expected one word, found 2"},
        {with(good, "HEIGHT 1", "LENGTH 1"), MalformedHeader, 7, -1, "'LENGTH' begins no line"},
        {with(good, "FIELDS x y z", "FIELDS x y"), MalformedHeader, 3, -1, "3 entries for the 2"},
        {with(good, "COUNT 1 1 1", "COUNT 1 1"), MalformedHeader, 5, -1, "2 entries for the 3"},
        {with(good, "x y z", "x y w"), MalformedHeader, 10, -1, "no z of COUNT 1"},
        {with(good, "x y z", "x y X"), MalformedHeader, 10, -1, "'x' and 'X' say the same"},
        {with(good, "4 4 4", "4 4 2"), MalformedHeader, 3, -1, "F has 4 or 8"},
        {with(with(good, "F F F", "F F I"), "4 4 4", "4 4 3"), MalformedHeader, 3, -1, "1 to 8"},
        {with(good, "F F F", "F F D"), MalformedHeader, 4, -1, "'D' is none of I, U and F"},
        {with(good, "1 1 1\n", "1 1 0\n"), MalformedHeader, 5, -1, "'0' numbers"},
        {with(good, "1 1 1\n", "1 1 2000000000\n"), MalformedHeader, 5, -1, "1 to 2^30"},
        {with(good, "WIDTH 1", "WIDTH -1"), MalformedHeader, 6, -1, "no whole number"},
        {with(good, "WIDTH 1", "WIDTH 1.5"), MalformedHeader, 6, -1, "no whole number"},
        {with(good, "WIDTH 1", "WIDTH 0"), MalformedHeader, 9, -1, "WIDTH times HEIGHT is 0"},
        {with(with(good, "WIDTH 1", "WIDTH 0"), "POINTS 1", "POINTS 0"), NoGeometry, 6, -1,
         "no points"},
        {with(good, "POINTS 1", "POINTS 2"), MalformedHeader, 9, -1, "2 points, but WIDTH"},
        {with(with(good, "WIDTH 1", "WIDTH 9223372036854775807"), "HEIGHT 1", "HEIGHT 3"),
         CountExceedsFile, 7, -1, "more than any file holds"},
        {with(good, "VIEWPOINT 0", "VIEWPOINT"), MalformedHeader, 8, -1, "seven numbers"},
        {with(good, "VIEWPOINT 0", "VIEWPOINT nan"), NonFiniteCoordinate, 8, -1, "not finite"},
        {with(good, "ascii", "text"), MalformedHeader, 10, -1, "'text' is none of"},
        {with(with(good, "WIDTH 1", "WIDTH 4"), "POINTS 1", "POINTS 4"), CountExceedsFile, 11, -1,
         "announces 4 points of 3 numbers"},
    };
    for (const Refusal& row : rows) { expect_refused(read_pcd, row); }
    expect_refused(read_pcd, {binary(), TooManyVertices, 11, -1, "the limit is 5"}, {5, 5});
}

TEST(PcdReader, RefusesBrokenTextAtItsLine)
{
    const std::string head =
        "VERSION .7\nFIELDS x y z rgba\nSIZE 4 4 4 4\nTYPE F F F U\nWIDTH 2\nHEIGHT 1\nDATA "
        "ascii\n";
    using enum Fault;
    const Refusal rows[] = {
        {head + "1 2 3 9\n1 2 3\n9", MalformedBody, 9, -1, "a point of 3 numbers; the header"},
        {head + "1 2 3 9\n1 2 3 9 4\n", MalformedBody, 9, -1, "more numbers than the 4"},
        {head + "1 2 3 9\n\n# no point\n", MalformedBody, 10, -1, "'#' is no number"},
        {head + "1 2 3 9          \n\n", Truncated, 10, -1, "after 1 of 2 points"},
        {head + "1 2 3 9\n1 2 3 9\n1 2 3 9\n", MalformedBody, 10, -1, "more lines than the 2"},
        {head + "1 2 3 9\n1 x 3 9\n", MalformedBody, 9, -1, "'x' is no number"},
        {head + "1 2 3 9\n1 2 3 4294967296\n", MalformedBody, 9, -1, "packed into 32 bits"},
        {head + "1 2 3 9.5\n1 2 3 4\n", MalformedBody, 8, -1, "packed into 32 bits"},
        {head + "1 2 3 9\n1 -inf 3 9\n", NonFiniteCoordinate, 9, -1, "point 1 has an infinite"},
        {head + "1 2 3 9\n1 1e16 3 9\n", CoordinateTooLarge, 9, -1, "1e15"},
        {head + "1 2 3 9\n1 1e999 3 9\n", CoordinateTooLarge, 9, -1, "1e15"},
        {head + "nan 2 3 9\n1 2 NaN 9\n", NoGeometry, -1, -1, "every point has a NaN"},
    };
    for (const Refusal& row : rows) { expect_refused(read_pcd, row); }
}

TEST(PcdReader, RefusesBrokenBytesAtTheirPlace)
{
    const std::string raw = binary(), packed = compressed();
    const auto body = static_cast<std::int64_t>(raw.find("binary\n") + 7);
    const auto lengths = static_cast<std::int64_t>(packed.find("compressed\n") + 11);
    const auto end = static_cast<std::int64_t>(raw.size());
    const auto stride = (end - body) / static_cast<std::int64_t>(count);
    std::string infinite = raw, large = raw, truncated = packed, lying = packed;
    put_bytes(infinite, static_cast<std::size_t>(body + 4 * stride), -inf);
    put_bytes(large, static_cast<std::size_t>(body + 5 * stride + 8), 1e16F);
    put_bytes(lying, static_cast<std::size_t>(lengths + 4), std::uint32_t{205});
    truncated.pop_back();
    std::string damaged = packed;
    damaged[static_cast<std::size_t>(lengths + 8)] = '\x20';  // back before the start
    std::string packed_infinite = by_field();
    put_bytes(packed_infinite, 8, inf);
    using enum Fault;
    const Refusal rows[] = {
        {raw.substr(0, raw.size() - 1), CountExceedsFile, -1, body,
         "announces 6 points of 36 bytes"},
        {raw + "x", MalformedBody, -1, end, "fewer than the 217"},
        {infinite, NonFiniteCoordinate, -1, body + 4 * stride, "point 4 has an infinite"},
        {large, CoordinateTooLarge, -1, body + 5 * stride, "point 5"},
        {header("binary_compressed") + "1234567", Truncated, -1,
         static_cast<std::int64_t>(header("binary_compressed").size() + 7), "two lengths"},
        {truncated, CountExceedsFile, -1, lengths, "compressed bytes, more than the file has left"},
        {lying, MalformedBody, -1, lengths + 4, "a body that unpacks to 205"},
        {damaged, MalformedBody, -1, lengths + 8, "no LZF data of 216 bytes"},
        {packed + "x", MalformedBody, -1, static_cast<std::int64_t>(packed.size()), "more bytes"},
        {compressed(packed_infinite), NonFiniteCoordinate, -1, lengths + 8, "point 2"},
        {plain("", {{0, 0, double{nan}}}), NoGeometry, -1, -1, "every point"},
    };
    for (const Refusal& row : rows) { expect_refused(read_pcd, row); }
}

TEST(PcdReader, DoesNotAllocateWhatTheHeaderClaims)
{
    std::string file =
        with(with(compressed(), "WIDTH 3", "WIDTH 59652323"), "POINTS 6", "POINTS 119304646");
    put_bytes(file, file.find("compressed\n") + 15, std::uint32_t{119'304'646U * 36U});  // 4.3 GB
    expect_refused(read_pcd,
                   {file, Fault::MalformedBody, -1,
                    static_cast<std::int64_t>(file.find("compressed\n") + 19), "no LZF"},
                   {200'000'000, 0});
}

TEST(PcdReader, StopsWhenTold)
{
    for (const std::string& file : {ascii(), binary(), compressed()}) {
        Progress progress;
        progress.stop();
        EXPECT_EQ(read_pcd(std::as_bytes(std::span(file)), {}, progress).error().fault,
                  Fault::Cancelled);
    }
}

TEST(PcdReader, KeepsItsPromisesOnBrokenBytes)
{
    EXPECT_EQ(broken_promise_of_mutants(read_pcd, ascii(), 4000, 1), "");
    EXPECT_EQ(broken_promise_of_mutants(read_pcd, binary(), 4000, 2), "");
    EXPECT_EQ(broken_promise_of_mutants(read_pcd, compressed(), 4000, 3), "");
}

}  // namespace
}  // namespace relight::test
