#include <array>
#include <limits>

#include "core/display/display.h"
#include "core/io/writers.h"
#include "tests/io/cloud_checks.h"
#include "tests/written.h"

namespace relight::test {
namespace {

// ASPRS LAS 1.4 R15: sizes of the public header block and of point records 0 to 10.
constexpr std::array<std::size_t, 5> header_sizes = {227, 227, 227, 235, 375};
constexpr std::array<std::size_t, 11> record_sizes = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
constexpr std::array<double, 3> scale = {0.01, -0.001, 1.16451354e-06};
constexpr std::array<double, 3> offset = {637301.2, -851217.56, 1692500.352};
constexpr std::size_t count = 3;
constexpr std::size_t vlr = 54 + 7;  // one such record before the points
constexpr std::size_t spare = 5;     // "extra bytes" of each record

Result<Mesh> las(std::string_view file)
{
    return read(read_las, file);
}

bool has_rgb(unsigned format)
{
    return format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10;
}
std::size_t rgb_at(unsigned format)
{
    return format == 2 ? 20 : format < 6 ? 28 : 30;
}

std::array<std::int32_t, 3> filed(std::size_t point)
{
    constexpr std::array<std::array<std::int32_t, 3>, count> xyz = {
        {{63714803, 84906247, 42224}, {-1, 0, 2147483647}, {3, -2147483647 - 1, 1}}};
    return xyz[point];
}

/// Version 1.minor, three points each filled with a letter but for what we read; then `tail`, which
/// the header of 1.3 calls waveforms and that of 1.4 an extended record.
std::string las_file(unsigned minor, unsigned format, std::uint16_t color = 0x8000,
                     const std::string& tail = "tail")
{
    const std::size_t points = header_sizes[minor] + vlr;
    const std::size_t length = record_sizes[format] + spare;
    std::string file(header_sizes[minor], '\0');
    file.replace(0, 4, "LASF");
    file[24] = 1;
    file[25] = static_cast<char>(minor);
    put_bytes(file, 94, static_cast<std::uint16_t>(header_sizes[minor]));
    put_bytes(file, 96, static_cast<std::uint32_t>(points));
    put_bytes(file, 100, std::uint32_t{1});
    file[104] = static_cast<char>(format);
    put_bytes(file, 105, static_cast<std::uint16_t>(length));
    put_bytes(file, 107, static_cast<std::uint32_t>(format < 6 ? count : 0));
    put_bytes(file, 131, scale);
    put_bytes(file, 155, offset);
    const std::uint64_t end = points + count * length;
    if (minor == 3) { put_bytes(file, 227, end); }
    if (minor == 4) {
        put_bytes(file, 235, end);
        put_bytes(file, 247, std::uint64_t{count});
    }
    std::string record(vlr, 'v');
    put_bytes(record, 20, std::uint16_t{7});
    file += record;
    for (std::size_t i = 0; i < count; ++i) {
        std::string point(length, static_cast<char>('a' + i));
        put_bytes(point, 0, filed(i));
        if (has_rgb(format)) {
            const auto shifted = static_cast<std::uint16_t>(color >> i);
            put_bytes(point, rgb_at(format), std::array<std::uint16_t, 3>{shifted, 0, color});
        }
        file += point;
    }
    return file + tail;
}

TEST(LasReader, ReadsTheSamplesWithTheCountsOfTheirSource)
{
    const std::string file = cloud("autzen-thin.las");
    const Result<Mesh> mesh = las(file);
    ASSERT_TRUE(mesh) << mesh.error().detail;
    EXPECT_EQ(broken_promise(*mesh, file.size()), "");
    EXPECT_EQ(mesh->format, "las");
    EXPECT_EQ(mesh->positions.size(), 10653U);
    // By struct.unpack: the first record and the last.
    EXPECT_EQ(mesh->positions[0], (Point3{63714803 * 0.01, 84906247 * 0.01, 42224 * 0.01}));
    EXPECT_EQ(mesh->positions.back(), (Point3{63730390 * 0.01, 85318642 * 0.01, 42448 * 0.01}));
    EXPECT_EQ(mesh->colors[0], to_float(srgb_eotf(Rgb8{86, 106, 86})));
    EXPECT_TRUE(notes_say(*mesh, "8-bit")) << "its largest code is 254";
    const Result<Mesh> later = las(cloud("test1_4.las"));
    ASSERT_TRUE(later) << later.error().detail;
    EXPECT_EQ(later->positions.size(), 1000U);
    EXPECT_TRUE(later->colors.empty());
}

TEST(LasReader, PositionsAreScaleTimesIntegerPlusOffsetToTheBit)
{
    for (unsigned minor = 0; minor < 5; ++minor) {
        for (unsigned format = 0; format < 11; ++format) {
            const std::string file = las_file(minor, format);
            const Result<Mesh> mesh = las(file);
            if (minor < 4 && format > 5) {  // counted in 64 bits, which only 1.4 has
                EXPECT_EQ(mesh.error().fault, Fault::NoGeometry);
                continue;
            }
            ASSERT_TRUE(mesh) << "1." << minor << ", format " << format << mesh.error().detail;
            EXPECT_EQ(broken_promise(*mesh, file.size()), "");
            EXPECT_TRUE(mesh->double_positions);
            ASSERT_EQ(mesh->positions.size(), count);
            for (std::size_t i = 0; i < count; ++i) {
                const auto at = filed(i);
                const Point3 expected = {at[0] * scale[0] + offset[0], at[1] * scale[1] + offset[1],
                                         at[2] * scale[2] + offset[2]};
                EXPECT_EQ(mesh->positions[i], expected) << i;
            }
            EXPECT_EQ(mesh->colors.size(), has_rgb(format) ? count : 0U) << format;
        }
    }
}

TEST(LasReader, ColoursAreSixteenBitsUnlessNoneNeedsMoreThanEight)
{
    const Result<Mesh> wide = las(las_file(2, 2, 0x8000));
    ASSERT_TRUE(wide);
    const auto decoded = [](double code) { return static_cast<float>(srgb_eotf(code)); };
    EXPECT_EQ(wide->colors[1], (Rgbf{decoded(0x4000 / 65535.0), 0, decoded(0x8000 / 65535.0)}));
    EXPECT_FALSE(notes_say(*wide, "8-bit"));
    const Result<Mesh> narrow = las(las_file(2, 2, 255));
    ASSERT_TRUE(narrow);
    EXPECT_EQ(narrow->colors[1], (Rgbf{decoded(127 / 255.0), 0, 1}));
    EXPECT_TRUE(notes_say(*narrow, "8-bit"));
    const Result<Mesh> just = las(las_file(2, 2, 256));
    ASSERT_TRUE(just);
    EXPECT_EQ(just->colors[0], (Rgbf{decoded(256 / 65535.0), 0, decoded(256 / 65535.0)}));
}

/// `file` with `value` put over what is at `at`.
template <class T>
std::string with(std::string file, std::size_t at, T value)
{
    put_bytes(file, at, value);
    return file;
}

TEST(LasReader, RefusesLazAndSaysWhatToDo)
{
    for (const char* name : {"simple.laz", "1.2-with-color.copc.laz"}) {
        expect_refused(read_las, {cloud(name), Fault::NotAvailable, -1, 104,
                                  "decompress it first, e.g. with las2las or pdal translate"});
    }
    expect_refused(read_las,
                   {with(las_file(2, 2), 104, '\x42'), Fault::NotAvailable, -1, 104, "LASzip"});
}

TEST(LasReader, RefusesBrokenFilesAtTheirByte)
{
    const std::string old = las_file(2, 3), wide = las_file(4, 7);
    std::string crowded = with(old, 100, std::uint32_t{2});  // the first leaves 50 bytes, not 54
    crowded.insert(227 + vlr, 50, 'x');
    put_bytes(crowded, 96, static_cast<std::uint32_t>(227 + vlr + 50));
    constexpr double inf = std::numeric_limits<double>::infinity();
    using enum Fault;
    const Refusal rows[] = {
        {"", EmptyFile, -1, -1, "no bytes"},
        {broken("a_las_point_count_lies.las"), CountExceedsFile, -1, 107, "announces 4000000000"},
        {broken("pdal_garbage_nVariableLength.las"), CountExceedsFile, -1, 100,
         "announces 1069128089 variable length records"},
        {"LASX" + old.substr(4), MalformedHeader, -1, 0, "LASF"},
        {old.substr(0, 226), Truncated, -1, 226, "takes 227 bytes"},
        {wide.substr(0, 374), Truncated, -1, 374, "takes 375 bytes"},
        {with(old, 25, '\5'), MalformedHeader, -1, 24, "version 1.5 is not read"},
        {with(old, 24, '\2'), MalformedHeader, -1, 24, "version 2.2"},
        {with(old, 104, '\13'), MalformedHeader, -1, 104, "point format 11"},
        {with(old, 94, std::uint16_t{226}), MalformedHeader, -1, 94, "a header of 226 bytes"},
        {with(wide, 94, std::uint16_t{374}), MalformedHeader, -1, 94, "needs 375"},
        {with(old, 96, std::uint32_t{226}), MalformedHeader, -1, 96, "start at byte 226"},
        {with(old, 96, std::uint32_t{9999}), MalformedHeader, -1, 96, "within the file"},
        {with(old, 100, std::uint32_t{2}), CountExceedsFile, -1, 100, "announces 2 variable"},
        {with(old, 227 + 20, std::uint16_t{8}), CountExceedsFile, -1, 100, "the 61 bytes"},
        {crowded, CountExceedsFile, -1, 100, "the 111 bytes"},
        {with(old, 105, std::uint16_t{33}), MalformedHeader, -1, 105, "format 3 takes 34"},
        {with(old, 139, 0.0), MalformedHeader, -1, 139, "the scale of y"},
        {with(old, 147, inf), NonFiniteCoordinate, -1, 147, "the scale of z"},
        {with(old, 155, -inf), NonFiniteCoordinate, -1, 155, "the offset of x"},
        {with(old, 107, std::uint32_t{0}), NoGeometry, -1, 107, "0 points"},
        {with(old, 107, std::uint32_t{4}), CountExceedsFile, -1, 107, "4 points of 39 bytes"},
        {with(wide, 247, UINT64_MAX), CountExceedsFile, -1, 247, "points of 41 bytes"},
        {with(wide, 107, std::uint32_t{2}), MalformedHeader, -1, 247, "but 2 in the older count"},
        {with(old, 131, 1e10), CoordinateTooLarge, -1, 288, "point 0"},
        {with(old, 171, 1e16), CoordinateTooLarge, -1, 288, "1e15"},
    };
    for (const Refusal& row : rows) { expect_refused(read_las, row); }
    expect_refused(read_las, {old, TooManyVertices, -1, 107, "the limit is 2"}, {2, 2});
    Progress progress;
    progress.stop();
    EXPECT_EQ(read_las(std::as_bytes(std::span(old)), {}, progress).error().fault, Cancelled);
}

TEST(LasReader, KeepsItsPromisesOnBrokenBytes)
{
    EXPECT_EQ(broken_promise_of_mutants(read_las, las_file(2, 3), 6000, 1), "");
    EXPECT_EQ(broken_promise_of_mutants(read_las, las_file(4, 7), 6000, 2), "");
}

constexpr std::array<Rgb8, count> painted = {{{0, 128, 255}, {1, 2, 3}, {254, 0, 77}}};

Result<std::string> write(std::string_view file, std::span<const Rgb8> colors = painted)
{
    return write_las(std::as_bytes(std::span(file)), colors);
}

TEST(LasWriter, WhatIsReadBackHasTheSamePositionsAndTheNewColours)
{
    for (unsigned minor = 0; minor < 5; ++minor) {
        for (unsigned format = 0; format < (minor < 4 ? 6U : 11U); ++format) {
            const std::string file = las_file(minor, format);
            const Result<std::string> written = write(file);
            ASSERT_TRUE(written) << written.error().detail;
            const Result<Mesh> before = las(file), after = las(*written);
            ASSERT_TRUE(before && after) << "1." << minor << ", format " << format;
            EXPECT_EQ(after->positions, before->positions);
            ASSERT_EQ(after->colors.size(), count);
            for (std::size_t i = 0; i < count; ++i) {
                EXPECT_EQ(after->colors[i], to_float(srgb_eotf(painted[i]))) << i;
            }
        }
    }
}

TEST(LasWriter, KeepsAllElse)
{
    struct Row {
        unsigned minor, from, to, minor_after;
    };
    // Formats 2 and 3 came with 1.2, 5 with 1.3, those from 6 with 1.4.
    for (const Row& row : {Row{0, 0, 2, 2}, Row{1, 1, 3, 2}, Row{2, 0, 2, 2}, Row{2, 2, 2, 2},
                           Row{2, 1, 3, 2}, Row{3, 4, 5, 3}, Row{3, 5, 5, 3}, Row{4, 6, 7, 4},
                           Row{4, 8, 8, 4}, Row{4, 9, 10, 4}, Row{4, 10, 10, 4}}) {
        const std::string file = las_file(row.minor, row.from);
        const std::size_t points = header_sizes[row.minor] + vlr;
        const std::size_t grown = record_sizes[row.to] - record_sizes[row.from];
        const std::size_t length = record_sizes[row.from] + spare;
        const std::size_t end = points + count * length;
        const Result<std::string> written = write(file);
        ASSERT_TRUE(written);
        std::string expected = file.substr(0, points);
        expected[25] = static_cast<char>(row.minor_after);
        expected[104] = static_cast<char>(row.to);
        put_bytes(expected, 105, static_cast<std::uint16_t>(length + grown));
        if (row.minor == 3) { put_bytes(expected, 227, std::uint64_t{end + count * grown}); }
        if (row.minor == 4) { put_bytes(expected, 235, std::uint64_t{end + count * grown}); }
        for (std::size_t i = 0; i < count; ++i) {
            std::string point = file.substr(points + i * length, length);
            point.insert(rgb_at(row.to), grown, '\0');
            for (std::size_t band = 0; band < 3; ++band) {
                const auto code = static_cast<std::uint16_t>(painted[i][band] * 257);
                put_bytes(point, rgb_at(row.to) + 2 * band, code);
            }
            expected += point;
        }
        EXPECT_EQ(*written, expected + "tail") << "1." << row.minor << ", format " << row.from;
    }
}

TEST(LasWriter, LeavesPlacesBeforeThePointsWhereTheyAre)
{
    std::string file = las_file(4, 6);
    put_bytes(file, 227, std::uint64_t{100});
    put_bytes(file, 235, std::uint64_t{0});  // no extended records
    const Result<std::string> written = write(file);
    ASSERT_TRUE(written);
    EXPECT_EQ(written->substr(227, 16), file.substr(227, 16));
}

TEST(LasWriter, PaintsTheSamples)
{
    for (const char* name : {"autzen-thin.las", "test1_4.las"}) {
        const std::string file = cloud(name);
        const Result<Mesh> before = las(file);
        ASSERT_TRUE(before);
        std::vector<Rgb8> colors;
        for (std::size_t i = 0; i < before->positions.size(); ++i) {
            colors.push_back({static_cast<unsigned char>(i), static_cast<unsigned char>(i / 7), 9});
        }
        const Result<std::string> written = write(file, colors);
        ASSERT_TRUE(written);
        const Result<Mesh> after = las(*written);
        ASSERT_TRUE(after) << after.error().detail;
        EXPECT_EQ(after->positions, before->positions);
        for (std::size_t i = 0; i < colors.size(); ++i) {
            ASSERT_EQ(after->colors[i], to_float(srgb_eotf(colors[i]))) << i;
        }
        // Painted once, it has room: painting again changes nothing but colours.
        const Result<std::string> twice = write(*written, colors);
        ASSERT_TRUE(twice);
        EXPECT_TRUE(*twice == *written);
    }
}

TEST(LasWriter, AllBlackStaysBlack)
{
    const std::vector<Rgb8> black(count, Rgb8{});
    const Result<std::string> written = write(las_file(2, 0), black);
    ASSERT_TRUE(written);
    const Result<Mesh> mesh = las(*written);
    ASSERT_TRUE(mesh);
    EXPECT_EQ(mesh->colors, std::vector<Rgbf>(count, Rgbf{}));
}

TEST(LasWriter, WhateverIsReadCanBePaintedAndReadBack)
{
    const auto check = [](std::string_view mutant) -> std::string {
        const Result<Mesh> before = las(mutant);
        if (!before) { return {}; }
        const std::vector<Rgb8> colors(before->positions.size(), Rgb8{3, 200, 255});
        const Result<std::string> written = write(mutant, colors);
        if (!written) { return {}; }
        const Result<Mesh> after = las(*written);
        if (!after) { return "unreadable: " + after.error().detail; }
        const bool kept = after->positions == before->positions &&
                          after->colors.back() == to_float(srgb_eotf(colors.back()));
        return kept ? "" : "something else was read back";
    };
    EXPECT_EQ(broken_promise_of_mutants(check, las_file(2, 0), 4000, 4), "");
    EXPECT_EQ(broken_promise_of_mutants(check, las_file(4, 9), 4000, 5), "");
}

TEST(LasWriter, RefusesWhatTheReaderRefusesAndRecordsWithoutRoom)
{
    EXPECT_EQ(write(cloud("simple.laz"), {}).error().fault, Fault::NotAvailable);
    std::string file = las_file(2, 0).substr(0, 227 + vlr) + std::string(65530, 'p');
    put_bytes(file, 105, std::uint16_t{65530});
    put_bytes(file, 107, std::uint32_t{1});
    const Rgb8 one{};
    const Result<std::string> written = write(file, std::span(&one, 1));
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().byte.value_or(0), 105U);
    EXPECT_NE(written.error().detail.find("no room"), std::string::npos);
}

}  // namespace
}  // namespace relight::test
