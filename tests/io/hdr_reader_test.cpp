#include <gtest/gtest.h>
#include <vtkHDRReader.h>
#include <vtkImageData.h>
#include <vtkNew.h>

#include <array>
#include <cmath>
#include <random>

#include "tests/io/mutants.h"
#include "tests/io/photometry_checks.h"

namespace relight::test {
namespace {

const std::string data = RELIGHT_TEST_DATA;
const std::string head = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";

using Rgbe = std::array<unsigned char, 4>;
using Row = std::vector<Rgbe>;

std::string resolution(std::size_t width, std::size_t height)
{
    return "-Y " + std::to_string(height) + " +X " + std::to_string(width) + '\n';
}

std::string bytes(std::initializer_list<int> values)
{
    std::string out;
    for (const int value : values) { out += static_cast<char>(value); }
    return out;
}

std::string flat(const Row& row)
{
    std::string out;
    for (const Rgbe& texel : row) { out += bytes({texel[0], texel[1], texel[2], texel[3]}); }
    return out;
}

/// Repetitions as (1, 1, 1, n), of higher digits base 256 after it.
std::string old_runs(const Row& row)
{
    std::string out;
    for (std::size_t x = 0; x < row.size();) {
        std::size_t more = 0;
        while (x + 1 + more < row.size() && row[x + 1 + more] == row[x]) { ++more; }
        out += flat({row[x]});
        x += 1 + more;
        for (; more > 0; more /= 256) { out += bytes({1, 1, 1, static_cast<int>(more % 256)}); }
    }
    return out;
}

/// A channel at a time: 128 + n and the byte that n repeat, or n and n bytes.
std::string packed(const Row& row)
{
    std::string out =
        bytes({2, 2, static_cast<int>(row.size() / 256), static_cast<int>(row.size() % 256)});
    for (std::size_t c = 0; c < 4; ++c) {
        for (std::size_t x = 0; x < row.size();) {
            std::size_t run = 1;
            while (run < 127 && x + run < row.size() && row[x + run][c] == row[x][c]) { ++run; }
            out += run > 1 ? bytes({static_cast<int>(128 + run)}) : bytes({1});
            out += static_cast<char>(row[x][c]);
            x += run;
        }
    }
    return out;
}

/// Runs and noise, of every exponent; no mantissa is that of a run.
Row random_row(std::size_t width, std::mt19937& random)
{
    Row row;
    while (row.size() < width) {
        const auto any = [&] { return static_cast<unsigned char>(random()); };
        const Rgbe texel{static_cast<unsigned char>(any() | 2U), any(), any(), any()};
        const std::size_t count = random() % 3 == 0 ? 1 + random() % 600 : 1;
        row.insert(row.end(), std::min(count, width - row.size()), texel);
    }
    return row;
}

/// The format's definition: m / 256 * 2^(e - 128), black where e = 0.
float value(unsigned char mantissa, unsigned char exponent)
{
    return exponent == 0 ? 0.0F : std::ldexp(static_cast<float>(mantissa), exponent - 128 - 8);
}

TEST(HdrReader, ReadsARealPictureAsVtkDoes)
{
    const std::string path = data + "/env/venice_sunset_64.hdr";
    const Result<Image> image = hdr(contents(path));
    ASSERT_TRUE(image) << image.error().detail;
    ASSERT_EQ(image->width, 64);
    ASSERT_EQ(image->height, 32);
    vtkNew<vtkHDRReader> reader;
    reader->SetFileName(path.c_str());
    reader->Update();
    for (int y = 0; y < 32; ++y) {
        for (int x = 0; x < 64; ++x) {
            for (int c = 0; c < 3; ++c) {
                // VTK's rows go up.
                ASSERT_EQ(image->pixels[image->at(x, y)][static_cast<std::size_t>(c)],
                          reader->GetOutput()->GetScalarComponentAsFloat(x, 31 - y, 0, c))
                    << x << ", " << y << ", " << c;
            }
        }
    }
}

TEST(HdrReader, DecodesWhatWasEncodedInEachPacking)
{
    std::mt19937 random(1);
    for (const std::size_t width : {1U, 2U, 7U, 8U, 127U, 128U, 129U, 300U, 32767U, 32768U}) {
        std::vector<Row> rows;
        std::string file = head;
        file += resolution(width, 5);
        for (const auto packing : {flat, old_runs, packed, old_runs, flat}) {
            rows.push_back(random_row(width, random));
            const bool fits = packing != packed || (width >= 8 && width < 32768);
            file += fits ? packing(rows.back()) : flat(rows.back());
        }
        const Result<Image> image = hdr(file);
        ASSERT_TRUE(image) << width << ": " << image.error().detail;
        for (std::size_t y = 0; y < rows.size(); ++y) {
            for (std::size_t x = 0; x < width; ++x) {
                for (std::size_t c = 0; c < 3; ++c) {
                    ASSERT_EQ(image->pixels[y * width + x][c], value(rows[y][x][c], rows[y][x][3]))
                        << "width " << width << ", row " << y << ", column " << x;
                }
            }
        }
    }
}

TEST(HdrReader, DividesOutWhatTheExposuresMultipliedIn)
{
    const std::string body = "\n-Y 1 +X 1\n" + bytes({128, 64, 32, 129});  // 1, 1/2, 1/4
    const Result<Image> image = hdr(
        "#?RGBE\r\nEXPOSURE= 2\r\nEXPOSURE=4.0\nCOLORCORR= 1 2 .5\nGAMMA=1\n# EXPOSURE\n" + body);
    ASSERT_TRUE(image) << image.error().detail;
    EXPECT_EQ(image->pixels[0], (Rgbf{1.0F / 8, 0.5F / 16, 0.25F / 4}));
}

TEST(HdrReader, RefusesEachBrokenFileAndSaysWhere)
{
    struct Case {
        std::string file;
        Fault fault;
        bool line;  // of text, in the header; else a byte of the body
        const char* says;
    };
    const std::string texel = bytes({128, 128, 128, 129});
    const std::string row8 = bytes({2, 2, 0, 8});
    const std::string channel8 = bytes({136, 1});
    const Case cases[] = {
        {"", Fault::EmptyFile, false, "no bytes"},
        {"P6 1 1", Fault::MalformedHeader, true, "#?RADIANCE"},
        {"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n", Fault::Truncated, true, "blank line"},
        {"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n" + texel, Fault::NotAvailable, true,
         "32-bit_rle_rgbe"},
        {"#?RADIANCE\nFORMAT=jpeg\n\n-Y 1 +X 1\n" + texel, Fault::MalformedHeader, true, "'jpeg'"},
        {"#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 1\n" + texel, Fault::OutOfRange, true, "'0'"},
        {"#?RADIANCE\nEXPOSURE=-1\n\n-Y 1 +X 1\n" + texel, Fault::OutOfRange, true, "'-1'"},
        {"#?RADIANCE\nEXPOSURE=nan\n\n-Y 1 +X 1\n" + texel, Fault::OutOfRange, true, "'nan'"},
        {"#?RADIANCE\nEXPOSURE=1e20\nEXPOSURE=1e20\n\n-Y 1 +X 1\n" + texel, Fault::OutOfRange, true,
         "product"},
        {"#?RADIANCE\nEXPOSURE=1 2\n\n-Y 1 +X 1\n" + texel, Fault::MalformedHeader, true,
         "one number"},
        {"#?RADIANCE\nCOLORCORR=1 1\n\n-Y 1 +X 1\n" + texel, Fault::OutOfRange, true, "'1 1'"},
        {head + "\n", Fault::MalformedHeader, true, "-Y height +X width"},
        {head + "-Y 0 +X 1\n", Fault::MalformedHeader, true, "1 or more"},
        {head + "-Y -1 +X 1\n", Fault::MalformedHeader, true, "1 or more"},
        {head + "-Y 1 +X 1 1\n" + texel, Fault::MalformedHeader, true, "-Y height +X width"},
        {head + "+Y 1 +X 1\n" + texel, Fault::NotAvailable, true, "mirrored"},
        {head + "+X 1 -Y 1\n" + texel, Fault::NotAvailable, true, "turned"},
        {head + "-Y 99999999999999999999 +X 1\n", Fault::CountExceedsFile, true, "bytes"},
        {head + "-Y 1 +X 99999999999999999999\n" + texel, Fault::CountExceedsFile, true, "bytes"},
        {head + "-Y 2 +X 1\n" + texel, Fault::CountExceedsFile, true, "4 bytes"},
        {head + "-Y 1 +X 3\n" + texel + texel, Fault::Truncated, false, "scanline 0"},
        {head + "-Y 1 +X 1\n" + texel + "x", Fault::MalformedBody, false, "1 bytes follow"},
        {head + "-Y 1 +X 2\n" + bytes({1, 1, 1, 2}) + texel, Fault::MalformedBody, false,
         "follow a texel"},
        {head + "-Y 1 +X 4\n" + texel + bytes({1, 1, 1, 4}), Fault::MalformedBody, false,
         "run of 4"},
        {head + "-Y 1 +X 8\n" + bytes({2, 2, 0, 9}) + texel + texel, Fault::MalformedBody, false,
         "the header, 8"},
        {head + "-Y 1 +X 8\n" + row8 + bytes({137, 1}) + texel, Fault::MalformedBody, false,
         "run of 9"},
        {head + "-Y 1 +X 8\n" + row8 + bytes({0, 1}) + texel, Fault::MalformedBody, false,
         "run of 0"},
        {head + "-Y 1 +X 8\n" + row8 + channel8 + channel8 + channel8, Fault::Truncated, false,
         "scanline 0"},
        {"#?RADIANCE\nEXPOSURE=1e-20\n\n-Y 1 +X 1\n" + bytes({255, 255, 255, 255}),
         Fault::OutOfRange, false, "too bright"},
        {contents(data + "/broken/a_hdr_huge_resolution.hdr"), Fault::CountExceedsFile, true,
         "2147483647"},
        {contents(data + "/broken/a_hdr_rle_overrun.hdr"), Fault::MalformedBody, false,
         "run of 127"},
    };
    for (const Case& c : cases) {
        const Result<Image> image = hdr(c.file);
        ASSERT_FALSE(image) << c.says;
        EXPECT_EQ(image.error().fault, c.fault) << c.says << ": " << image.error().detail;
        EXPECT_NE(image.error().detail.find(c.says), std::string::npos)
            << c.says << ": " << image.error().detail;
        EXPECT_EQ(image.error().line.has_value(), c.line) << c.says;
        EXPECT_EQ(image.error().byte.has_value(), !c.line && c.fault != Fault::EmptyFile) << c.says;
    }
}

TEST(HdrReader, HoldsToItsLimitAndStopsWhenTold)
{
    const std::string file = head + "-Y 2 +X 3\n" + flat(Row(6, {128, 128, 128, 129}));
    EXPECT_TRUE(hdr(file, 6));
    EXPECT_EQ(hdr(file, 5).error().fault, Fault::OutOfRange);
    EXPECT_NE(hdr(file, 5).error().detail.find("the limit is 5"), std::string::npos);
    Progress progress;
    progress.stop();
    EXPECT_EQ(read_hdr(std::as_bytes(std::span(file)), 6, progress).error().fault,
              Fault::Cancelled);
}

TEST(HdrReader, KeepsItsPromisesOnBrokenFiles)
{
    const auto check = [](std::string_view mutant) { return broken_promise(read_hdr, mutant); };
    EXPECT_EQ(
        broken_promise_of_mutants(check, contents(data + "/env/venice_sunset_64.hdr"), 500, 1), "");
    std::mt19937 random(2);
    std::string small = "#?RADIANCE\nEXPOSURE=2\nFORMAT=32-bit_rle_rgbe\n\n" + resolution(9, 6);
    for (const auto packing : {packed, old_runs, flat, packed, old_runs, packed}) {
        small += packing(random_row(9, random));
    }
    EXPECT_EQ(broken_promise_of_mutants(check, small, 20'000, 3), "");
}

}  // namespace
}  // namespace relight::test
