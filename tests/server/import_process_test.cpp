#include "server/import_process.h"

#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineOutputFile.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/io/mutants.h"
#include "tests/server/exr_files.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif

namespace relight::test {
namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

const std::string data = RELIGHT_TEST_DATA;

Result<ImportedImage> import(std::string_view file, ImportLimits limits = {})
{
    limits.program = RELIGHT_IMPORT_PROGRAM;
    Progress progress;
    return import_exr(std::as_bytes(std::span(file)), limits, progress);
}

void expect_as_openexr_reads(const std::string& file, const std::vector<std::string>& names,
                             const std::string& what)
{
    const auto imported = import(file);
    ASSERT_TRUE(imported) << what << ": " << imported.error().detail;
    std::vector<float> expected = read_by_openexr(file, names);
    std::size_t negatives = 0;
    for (float& value : expected) {
        negatives += value < 0.0F ? 1 : 0;
        value = std::max(value, 0.0F);
    }
    const Image& image = imported->image;
    ASSERT_EQ(image.at(0, image.height) * names.size(), expected.size()) << what;
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            ASSERT_EQ(image.pixels[i][c], expected[names.size() * i + c % names.size()])
                << what << " at texel " << i;
        }
    }
    EXPECT_EQ(imported->notes.empty(), negatives == 0) << what;
    if (negatives > 0) {
        EXPECT_EQ(imported->notes.at(0), std::to_string(negatives) + " values below 0 became 0");
    }
}

TEST(ImportExr, GivesEverySampleAsOpenExrReadsIt)
{
    for (const char* name : {"park_512", "night_512", "lux_studiolights_piz"}) {
        const std::string file = contents(data + "/env/" + name + ".exr");
        expect_as_openexr_reads(file, {"R", "G", "B"}, name);
        const auto imported = import(file);
        ASSERT_TRUE(imported) << name;
        EXPECT_EQ(imported->image.width, 512) << name;
        EXPECT_EQ(imported->image.height, 256) << name;
    }
}

TEST(ImportExr, GivesEveryCompressionTypeAndLayoutAsOpenExrReadsIt)
{
    for (int compression = 0; compression < Imf::NUM_COMPRESSION_METHODS; ++compression) {
        for (const Imf::PixelType type : {Imf::HALF, Imf::FLOAT}) {
            for (const int tile : {0, 8}) {
                const Filed filed{.type = type,
                                  .compression = static_cast<Imf::Compression>(compression),
                                  .tile = tile};
                expect_as_openexr_reads(exr(filed), {"R", "G", "B"},
                                        "compression " + std::to_string(compression) + ", type " +
                                            std::to_string(type) + ", tile " +
                                            std::to_string(tile));
            }
        }
    }
    expect_as_openexr_reads(exr({.channels = {"R", "G", "B", "A", "depth.Z"}}), {"R", "G", "B"},
                            "more channels");
    expect_as_openexr_reads(exr({.channels = {"Y"}}), {"Y"}, "grey");
    expect_as_openexr_reads(exr({.channels = {"Y", "A"}, .tile = 8}), {"Y"}, "grey and alpha");
    expect_as_openexr_reads(exr({.window = {{-7, 11}, {12, 40}}}), {"R", "G", "B"}, "offset");
    expect_as_openexr_reads(exr({.window = {{-7, -9}, {-7, -9}}}), {"R", "G", "B"}, "one texel");
    expect_as_openexr_reads(exr({.order = Imf::DECREASING_Y}), {"R", "G", "B"}, "upwards");
    expect_as_openexr_reads(exr({.tile = 8, .levels = Imf::MIPMAP_LEVELS}), {"R", "G", "B"},
                            "mipmap");
    expect_as_openexr_reads(exr({.first = -2.0F}), {"R", "G", "B"}, "negative");
}

TEST(ImportExr, FindsTheImporterBesideTheRunningProgram)
{
    Progress progress;
    const std::string file = exr({});
    EXPECT_TRUE(import_exr(std::as_bytes(std::span(file)), {}, progress));
}

void expect_refused(std::string_view file, Fault fault, std::string_view says,
                    const ImportLimits& limits = {})
{
    const auto imported = import(file, limits);
    ASSERT_FALSE(imported) << says;
    EXPECT_EQ(fault_code(imported.error().fault), fault_code(fault))
        << says << ": " << imported.error().detail;
    EXPECT_NE(imported.error().detail.find(says), std::string::npos) << imported.error().detail;
}

std::string deep_file()
{
    Imf::Header header(1, 1);
    header.setType(Imf::DEEPSCANLINE);
    header.compression() = Imf::NO_COMPRESSION;
    for (const char* name : {"R", "G", "B"}) { header.channels().insert(name, Imf::Channel()); }
    Memory file;
    {
        unsigned samples = 0;
        half* none = nullptr;
        Imf::DeepScanLineOutputFile output(file, header, 0);
        Imf::DeepFrameBuffer buffer;
        buffer.insertSampleCountSlice(
            Imf::Slice(Imf::UINT, reinterpret_cast<char*>(&samples), 4, 4));
        for (const char* name : {"R", "G", "B"}) {
            buffer.insert(name, Imf::DeepSlice(Imf::HALF, reinterpret_cast<char*>(&none), 8, 8, 2));
        }
        output.setFrameBuffer(buffer);
        output.writePixels(1);
    }
    return file.text();
}

std::string two_parts()
{
    std::vector<Imf::Header> headers(2, Imf::Header(1, 1));
    for (Imf::Header& header : headers) {
        header.setName(&header == headers.data() ? "left" : "right");
        header.setType(Imf::SCANLINEIMAGE);
        for (const char* name : {"R", "G", "B"}) { header.channels().insert(name, Imf::Channel()); }
    }
    Memory file;
    {
        const Imf::MultiPartOutputFile output(file, headers.data(), 2);  // parts left empty
    }
    return file.text();
}

TEST(ImportExr, RefusesWhatItDoesNotReadAndSaysWhatItReads)
{
    expect_refused("", Fault::EmptyFile, "no bytes");
    expect_refused("v/1", Fault::Truncated, "ends before");
    expect_refused("#?RADIANCE\n", Fault::MalformedHeader, "OpenEXR");
    expect_refused(deep_file(), Fault::NotAvailable, "deep");
    expect_refused(two_parts(), Fault::NotAvailable, "several parts");
    expect_refused(exr({.channels = {"R", "G"}}), Fault::NotAvailable, "channels are G, R;");
    expect_refused(exr({.channels = {"left.R", "left.G", "left.B"}}), Fault::NotAvailable,
                   "left.B");
    expect_refused(exr({.channels = {"Y", "RY", "BY"}}), Fault::NotAvailable, "without RY and BY");
    expect_refused(exr({.type = Imf::UINT}), Fault::NotAvailable, "integers");
    expect_refused(exr({.window = {{0, 0}, {19, 19}}, .sampling = 2}), Fault::NotAvailable,
                   "for every texel");
    expect_refused(exr({.first = std::numeric_limits<float>::infinity()}), Fault::NotFinite,
                   "column 0, row 0");
    expect_refused(exr({.type = Imf::FLOAT, .first = std::nanf("")}), Fault::NotFinite, "column 0");
    expect_refused(exr({}), Fault::OutOfRange, "20 x 17 texels; the limit is 339", {.pixels = 339});
    EXPECT_TRUE(import(exr({}), {.pixels = 340}));
}

/// A file whose data window is set to other corners.
std::string with_window(std::string file, std::array<std::int32_t, 4> corners)
{
    const std::string mark("dataWindow\0box2i\0\x10\0\0\0", 21);
    const std::size_t at = file.find(mark);
    EXPECT_NE(at, std::string::npos);
    std::memcpy(file.data() + at + mark.size(), corners.data(), sizeof corners);
    return file;
}

TEST(ImportExr, RefusesBombsQuicklyAndByName)
{
    constexpr std::int32_t most = std::numeric_limits<std::int32_t>::max();
    const Clock::time_point begin = Clock::now();
    expect_refused(with_window(exr({}), {0, 0, most, most}), Fault::OutOfRange, "the limit is");
    expect_refused(with_window(exr({}), {-most - 1, -most - 1, most, most}), Fault::OutOfRange,
                   "4294967296 x 4294967296 texels");
    expect_refused(with_window(exr({}), {5, 0, 4, 16}), Fault::MalformedHeader, "empty");
    for (const std::array<std::int32_t, 4> corners :
         {std::array{0, 0, 8191, 4095}, {0, 0, 0, (1 << 25) - 1}, {0, 0, (1 << 25) - 1, 0}}) {
        for (const int tile : {0, 8}) {
            EXPECT_FALSE(import(with_window(exr({.tile = tile}), corners)));
        }
    }
    EXPECT_LT(Clock::now() - begin, 10s);
}

TEST(ImportExr, HoldsTheImporterToItsMemory)
{
    if (sanitized) { GTEST_SKIP() << "a sanitizer's shadow memory allows no bound"; }
    const std::string file =  // 24 MB as R G B
        exr({.channels = {"Y"}, .type = Imf::FLOAT, .window = {{0, 0}, {2047, 1023}}});
    EXPECT_TRUE(import(file, {.memory = 256ULL << 20U}));
    expect_refused(file, Fault::ImportFailed, "more memory than the 32 MiB",
                   {.memory = 32ULL << 20U});
}

TEST(ImportExr, RefusesTheBrokenFilesOfOthers)
{
    expect_refused(contents(data + "/broken/tinyexr_issue62.exr"), Fault::NotAvailable, "version");
    expect_refused(contents(data + "/broken/tinyexr_issue167.exr"), Fault::MalformedBody,
                   "not what OpenEXR");
}

TEST(ImportExr, RefusesEveryTruncation)
{
    for (const char* name : {"park_512", "lux_studiolights_piz"}) {
        const std::string file = contents(data + "/env/" + name + ".exr");
        for (std::size_t part = 0; part < 64; ++part) {
            const Clock::time_point begin = Clock::now();
            EXPECT_FALSE(import(file.substr(0, part * file.size() / 64))) << name << ' ' << part;
            EXPECT_LT(Clock::now() - begin, 5s) << name << ' ' << part;
        }
    }
}

TEST(ImportExr, SurvivesFlippedBits)
{
    std::mt19937 random(1);
    const int rounds = sanitized ? 12 : 60;
    for (const Imf::Compression compression :
         {Imf::PIZ_COMPRESSION, Imf::ZIP_COMPRESSION, Imf::DWAB_COMPRESSION, Imf::B44_COMPRESSION,
          Imf::PXR24_COMPRESSION, Imf::RLE_COMPRESSION}) {
        const std::string good = exr({.compression = compression, .tile = random() % 2 ? 8 : 0});
        for (int round = 0; round < rounds; ++round) {
            std::string file = good;
            for (std::size_t flips = 1 + random() % 4; flips > 0; --flips) {
                file[random() % file.size()] ^= static_cast<char>(1U << random() % 8);
            }
            const Clock::time_point begin = Clock::now();
            const auto imported = import(file);
            EXPECT_LT(Clock::now() - begin, 5s) << compression << ' ' << round;
            if (!imported) { EXPECT_FALSE(imported.error().detail.empty()); }
        }
    }
}

TEST(ImportExr, CostsLittleBeyondTheDecoding)
{
    const std::string file = exr({.window = {{0, 0}, {0, 0}}});
    std::chrono::duration<double, std::milli> least{1e9}, sum{};
    constexpr int rounds = 50;
    for (int round = 0; round < rounds; ++round) {
        const Clock::time_point begin = Clock::now();
        ASSERT_TRUE(import(file));
        const std::chrono::duration<double, std::milli> took = Clock::now() - begin;
        least = std::min(least, took);
        sum += took;
    }
    std::printf("import of one texel: least %.2f ms, mean %.2f ms\n", least.count(),
                sum.count() / rounds);
    if (!sanitized) { EXPECT_LT(least, 15ms); }
}

}  // namespace
}  // namespace relight::test
