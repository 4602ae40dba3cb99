#include <gtest/gtest.h>
#include <stb/stb_image.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>

#include "core/io/photometry.h"
#include "core/io/writers.h"

namespace relight {
namespace {

std::vector<Rgbf> read_back(const std::string& hdr, int width, int height)
{
    Progress progress;
    const auto image = read_hdr(std::as_bytes(std::span(hdr)), 1'000'000, progress);
    EXPECT_TRUE(image) << image.error().detail;
    if (!image) { return {}; }
    EXPECT_EQ(image->width, width);
    EXPECT_EQ(image->height, height);
    return image->pixels;
}

/// As an independent reader decodes it.
std::vector<Rgbf> read_by_stb(const std::string& hdr, int width, int height)
{
    int columns = 0, rows = 0, components = 0;
    const std::unique_ptr<float, void (*)(void*)> values(
        stbi_loadf_from_memory(reinterpret_cast<const stbi_uc*>(hdr.data()),
                               static_cast<int>(hdr.size()), &columns, &rows, &components, 3),
        stbi_image_free);
    EXPECT_NE(values, nullptr) << stbi_failure_reason();
    if (!values) { return {}; }
    EXPECT_EQ(columns, width);
    EXPECT_EQ(rows, height);
    std::vector<Rgbf> pixels;
    for (int i = 0; i < columns * rows; ++i) {
        const float* const at = values.get() + 3 * static_cast<std::ptrdiff_t>(i);
        pixels.push_back({at[0], at[1], at[2]});
    }
    return pixels;
}

/// What a texel of these bytes means.
Rgbf decoded(const std::array<int, 3>& mantissas, int exponent)
{
    Rgbf out{};
    for (std::size_t band = 0; band < 3; ++band) {
        out[band] = static_cast<float>(std::ldexp(mantissas[band], exponent - 128 - 8));
    }
    return out;
}

TEST(WriteHdr, WhatATexelCanSayIsSaidExactly)
{
    std::vector<Rgbf> pixels;
    std::mt19937 random(3);
    const auto any = [&] { return static_cast<int>(random() % 256); };
    for (int e = 1; e < 256; ++e) {
        for (int m = 128; m < 256; ++m) {
            std::array<int, 3> mantissas{any(), any(), any()};
            mantissas[random() % 3] = m;
            pixels.push_back(decoded(mantissas, e));
        }
    }
    const std::string hdr = write_hdr(128, 255, pixels, {});
    EXPECT_EQ(read_back(hdr, 128, 255), pixels);
    EXPECT_EQ(read_by_stb(hdr, 128, 255), pixels);
}

/// Noise, long and short runs, and their mixtures.
std::vector<Rgbf> picture(int width, int height, unsigned seed)
{
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> stops(-20.0F, 20.0F), share(0.0F, 1.0F);
    std::vector<Rgbf> pixels;
    const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    while (pixels.size() < count) {
        const float scale = std::exp2(stops(random));
        const Rgbf color{scale * share(random), scale * share(random), scale * share(random)};
        const auto run = random() % 4 == 0 ? random() % 400 : 1 + random() % 5;
        pixels.insert(pixels.end(), run, color);
    }
    pixels.resize(count);
    return pixels;
}

TEST(WriteHdr, EveryWidthReadsBackWithinA256thOfTheLargestBand)
{
    const std::pair<int, int> sizes[] = {{1, 3},     {7, 5},     {8, 5},    {9, 40},
                                         {127, 7},   {128, 7},   {129, 7},  {130, 7},
                                         {1000, 20}, {32767, 2}, {32768, 2}};
    for (const auto& [width, height] : sizes) {
        const std::vector<Rgbf> pixels = picture(width, height, 7);
        const std::string hdr = write_hdr(width, height, pixels, {});
        const std::vector<Rgbf> back = read_back(hdr, width, height);
        ASSERT_EQ(back.size(), pixels.size());
        for (std::size_t i = 0; i < back.size(); ++i) {
            const float largest = *std::max_element(pixels[i].begin(), pixels[i].end());
            for (std::size_t band = 0; band < 3; ++band) {
                ASSERT_NEAR(back[i][band], pixels[i][band], largest / 256.0F) << width;
            }
        }
        EXPECT_EQ(read_by_stb(hdr, width, height), back) << width;
    }
}

TEST(WriteHdr, WhatIsOutOfRangeIsCutAndWhatIsBelowZeroIsBlack)
{
    const float brightest = 255.0F * 0x1p119F;
    const float inf = std::numeric_limits<float>::infinity();
    const std::vector<Rgbf> pixels{{3e38F, 1.0F, brightest}, {inf, 0, 0},
                                   {-1.0F, 0.5F, -inf},      {-1.0F, -2.0F, -0.0F},
                                   {0x1p-130F, 0, 0},        {1e-45F, 1e-45F, 1e-45F},
                                   {0x1p-128F, 0, 0}};
    const std::vector<Rgbf> expected{
        {brightest, 0, brightest}, {brightest, 0, 0}, {0, 0.5F, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0},
        {0x1p-128F, 0, 0}};
    EXPECT_EQ(read_back(write_hdr(7, 1, pixels, {}), 7, 1), expected);
    const std::vector<Rgbf> faint{{0x1.8p-129F, 0, 0}}, black{{0, 0, 0}};
    EXPECT_EQ(write_hdr(1, 1, faint, {}), write_hdr(1, 1, black, {}));
}

TEST(WriteHdr, AValueNextToAPowerOfTwoRoundsUpToIt)
{
    const float near = std::nextafter(2.0F, 0.0F);  // its mantissa of 8 bits would be 256
    const std::vector<Rgbf> pixels{{near, 1.0F, 0.25F}};
    EXPECT_EQ(read_back(write_hdr(1, 1, pixels, {}), 1, 1),
              (std::vector<Rgbf>{{2.0F, 1.0F, 0.25F}}));
}

TEST(WriteHdr, ALineOfOneColourTakesLittleAndNoiseHardlyMoreThanItsBytes)
{
    const std::vector<Rgbf> flat(std::size_t{10'000}, Rgbf{0.2F, 0.3F, 0.4F});
    EXPECT_LT(write_hdr(1000, 10, flat, {}).size(), 10U * (4 + 4 * 2 * 8) + 60);
    std::mt19937 random(1);
    std::vector<Rgbf> noise;
    while (noise.size() < 10'000) {  // literals as long as they get
        const auto any = [&] { return static_cast<int>(random() % 256); };
        noise.push_back(decoded({any(), any(), 255}, 128));
    }
    const std::string hdr = write_hdr(1000, 10, noise, {});
    EXPECT_LT(static_cast<double>(hdr.size()), 2.1 * 1000 * 10);  // blue and exponent are runs
    EXPECT_EQ(read_back(hdr, 1000, 10), noise);
}

TEST(WriteHdr, NoCommentGetsOutOfItsLine)
{
    const std::vector<Rgbf> pixels(9, Rgbf{1, 0.5F, 0.25F});
    const std::vector<std::string> comments{"radiance in W/(m^2 sr)\nEXPOSURE=2\n\n-Y 1 +X 1\n", "",
                                            "EXPOSURE=4"};
    const std::string hdr = write_hdr(9, 1, pixels, comments);
    EXPECT_EQ(read_back(hdr, 9, 1), pixels);
    EXPECT_TRUE(hdr.starts_with(
        "#?RADIANCE\n# radiance in W/(m^2 sr) EXPOSURE=2  -Y 1 +X 1 \n# \n# EXPOSURE=4\n"
        "FORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 9\n"));
}

std::vector<Rgb8> smooth_picture(int width, int height)
{
    std::vector<Rgb8> pixels;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const auto code = [](double v) {
                return static_cast<unsigned char>(std::lround(127.5 + 127.5 * v));
            };
            const double u = static_cast<double>(x) / width, v = static_cast<double>(y) / height;
            pixels.push_back({code(2.0 * v - 1.0), code(std::sin(5.0 * u)),
                              code(std::cos(4.0 * u * v))});  // red: dark above, bright below
        }
    }
    return pixels;
}

double psnr(std::span<const Rgb8> a, std::span<const Rgb8> b)
{
    double squares = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        for (std::size_t band = 0; band < 3; ++band) {
            const double d = static_cast<double>(a[i][band]) - static_cast<double>(b[i][band]);
            squares += d * d;
        }
    }
    return 10.0 * std::log10(255.0 * 255.0 * 3.0 * static_cast<double>(a.size()) / squares);
}

std::vector<Rgb8> decoded(const std::string& jpeg, int width, int height)
{
    int columns = 0, rows = 0, components = 0;
    const std::unique_ptr<stbi_uc, void (*)(void*)> codes(
        stbi_load_from_memory(reinterpret_cast<const stbi_uc*>(jpeg.data()),
                              static_cast<int>(jpeg.size()), &columns, &rows, &components, 0),
        stbi_image_free);
    EXPECT_NE(codes, nullptr) << stbi_failure_reason();
    EXPECT_EQ(components, 3);
    EXPECT_EQ(columns, width);
    EXPECT_EQ(rows, height);
    std::vector<Rgb8> pixels;
    for (int i = 0; codes && i < columns * rows; ++i) {
        const stbi_uc* const at = codes.get() + 3 * static_cast<std::ptrdiff_t>(i);
        pixels.push_back({at[0], at[1], at[2]});
    }
    return pixels;
}

TEST(WriteJpeg, ASmoothPictureReadsBackAlike)
{
    for (const auto& [width, height] : {std::pair(320, 200), std::pair(37, 51)}) {
        const std::vector<Rgb8> pixels = smooth_picture(width, height);
        const std::string jpeg = write_jpeg(width, height, pixels);
        const std::vector<Rgb8> back = decoded(jpeg, width, height);
        ASSERT_EQ(back.size(), pixels.size());
        EXPECT_GT(psnr(pixels, back), 35.0);
    }
    const std::vector<Rgb8> red{{255, 0, 0}};
    EXPECT_GT(psnr(decoded(write_jpeg(1, 1, red), 1, 1), red), 35.0);
}

TEST(WriteJpeg, MoreQualityIsMoreBytesAndLessError)
{
    const std::vector<Rgb8> pixels = smooth_picture(200, 100);
    std::size_t bytes = 0;
    double quality = 0.0;
    for (const int q : {1, 30, 92, 100}) {
        const std::string jpeg = write_jpeg(200, 100, pixels, q);
        const double now = psnr(pixels, decoded(jpeg, 200, 100));
        EXPECT_GT(jpeg.size(), bytes) << q;
        EXPECT_GT(now, quality) << q;
        bytes = jpeg.size();
        quality = now;
    }
}

TEST(WriteJpeg, ItIsBaselineAndTheSameEachTime)
{
    const std::vector<Rgb8> pixels = smooth_picture(64, 64);
    const std::string jpeg = write_jpeg(64, 64, pixels);
    EXPECT_EQ(jpeg, write_jpeg(64, 64, pixels));
    EXPECT_TRUE(jpeg.starts_with("\xFF\xD8\xFF\xE0"));  // JFIF, whose pictures are sRGB
    std::size_t at = 2;                                 // from marker to marker, up to the frame's
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(jpeg[i]); };
    while (byte(at + 1) < 0xC0 || byte(at + 1) > 0xC3) {
        at += 2 + 256U * byte(at + 2) + byte(at + 3);
    }
    EXPECT_EQ(byte(at + 1), 0xC0);  // SOF0; SOF2 would be progressive
}

}  // namespace
}  // namespace relight
