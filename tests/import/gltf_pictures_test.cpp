#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/import/gltf_images.h"
#include "tests/import/gltf_texts.h"

namespace relight::test {
namespace {

using Texel = std::array<std::uint8_t, 4>;

/// PNG, 2 x 1, 16 bits a channel: 1234 ABCD 0000, FFFF 80FF 7F01.
const std::string deep_png_base64 =
    "iVBORw0KGgoAAAANSUhEUgAAAAIAAAABEAIAAAAr0DSeAAAAFUlEQVR4nGMQMll9loHh//+G//"
    "WMACH1Bby0QuguAAAAAElFTkSuQmCC";

Result<Texture> decoded(std::string_view bytes, std::uint64_t most_pixels = 4096)
{
    gltf::Notes notes;
    try {
        return gltf::decode_picture(std::as_bytes(std::span(bytes)), "/images/0", most_pixels,
                                    notes);
    } catch (const gltf::Refusal& refusal) {
        return refusal.error;
    }
}

/// A material whose emission shows that image.
Json showing(const Json& picture)
{
    return gltf_with({{"materials", {{{"emissiveTexture", {{"index", 0}}}}}},
                      {"textures", {{{"source", 0}}}},
                      {"images", {picture}}});
}

/// Smooth, as JPEG likes it; 16 x 16, RGB.
std::vector<std::uint8_t> gradient()
{
    std::vector<std::uint8_t> codes;
    for (int y = 0; y < 16; ++y) {
        for (int x = 0; x < 16; ++x) {
            for (const int code : {15 * x, 15 * y, 128}) {
                codes.push_back(static_cast<std::uint8_t>(code));
            }
        }
    }
    return codes;
}

/// The bytes with a big-endian number written over those at `at`.
std::string patched(const std::string& bytes, std::size_t at, std::uint32_t number)
{
    std::string digits;
    for (const unsigned shift : {24U, 16U, 8U, 0U}) {
        digits += static_cast<char>(number >> shift & 0xFFU);
    }
    return bytes.substr(0, at) + digits + bytes.substr(at + 4);
}

TEST(GltfPicture, OfAPngHasItsTexelsFromTheTopLeftOn)
{
    const auto rgba =
        decoded(png(2, 2, 4, {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16}));
    ASSERT_TRUE(rgba) << detail_of(rgba);
    EXPECT_EQ(rgba->width, 2);
    EXPECT_EQ(rgba->height, 2);
    EXPECT_EQ(rgba->texels,
              (std::vector<Texel>{{1, 2, 3, 4}, {5, 6, 7, 8}, {9, 10, 11, 12}, {13, 14, 15, 16}}));
}

TEST(GltfPicture, OfFewerChannelsIsGreyAndOpaque)
{
    EXPECT_EQ(decoded(png(1, 1, 3, {1, 2, 3}))->texels.at(0), (Texel{1, 2, 3, 255}));
    EXPECT_EQ(decoded(png(1, 1, 1, {7}))->texels.at(0), (Texel{7, 7, 7, 255}));
    EXPECT_EQ(decoded(png(1, 1, 2, {7, 9}))->texels.at(0), (Texel{7, 7, 7, 9}));
}

TEST(GltfPicture, OfAJpegIsCloseToWhatWasEncoded)
{
    const auto codes = gradient();
    const auto picture = decoded(jpeg(16, 16, 3, codes));
    ASSERT_TRUE(picture) << detail_of(picture);
    ASSERT_EQ(picture->texels.size(), 256U);
    for (std::size_t i = 0; i < 256; ++i) {
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_NEAR(picture->texels[i][c], codes[3 * i + c], 6);
        }
        EXPECT_EQ(picture->texels[i][3], 255);
    }
}

TEST(GltfPicture, Of16BitsLosesItsLowerBytesAndSaysSo)
{
    const auto look = look_of(showing({{"uri", "data:image/png;base64," + deep_png_base64}}));
    ASSERT_TRUE(look) << detail_of(look);
    EXPECT_EQ(look->textures.at(0).texels,
              (std::vector<Texel>{{0x12, 0xAB, 0x00, 255}, {0xFF, 0x80, 0x7F, 255}}));
    ASSERT_EQ(look->notes.size(), 1U);
    EXPECT_NE(look->notes[0].find("16 bits"), std::string::npos);
}

TEST(GltfPicture, IsDecodedOnceForAllTexturesThatShowIt)
{
    Json gltf = showing(image(dot(50)));
    gltf["images"].push_back(image(dot(60)));
    gltf["samplers"] = {{{"wrapS", 33071}}};
    gltf["textures"] = {{{"source", 0}}, {{"source", 1}}, {{"source", 0}, {"sampler", 0}}};
    gltf["materials"][0]["normalTexture"] = {{"index", 2}};
    gltf["materials"].push_back({{"emissiveTexture", {{"index", 2}}}});
    const auto look = look_of(gltf);
    ASSERT_TRUE(look) << detail_of(look);
    EXPECT_EQ(look->textures.size(), 1U);
    EXPECT_EQ(look->maps[0].emissive->texture, look->maps[0].normal->texture);
    EXPECT_EQ(look->maps[0].emissive->wrap_u, Wrap::Repeat);
    EXPECT_EQ(look->maps[0].normal->wrap_u, Wrap::ClampToEdge);
    EXPECT_EQ(look->maps[1].emissive->wrap_u, Wrap::ClampToEdge);
}

TEST(GltfPicture, ThatNoMaterialShowsIsNotLookedAt)
{
    Json gltf = showing(image(dot(50)));
    gltf["images"].push_back(image("no picture"));
    gltf["images"].push_back({{"uri", "elsewhere.png"}});
    gltf["textures"].push_back({{"source", 1}});
    gltf["materials"][0]["occlusionTexture"] = {{"index", 1}};
    const auto look = look_of(gltf);
    ASSERT_TRUE(look) << detail_of(look);
    EXPECT_EQ(look->textures.size(), 1U);
}

TEST(GltfPicture, BesideAWebPIsTakenInstead)
{
    Json gltf = showing(image(dot(50)));
    gltf["images"].push_back(image("RIFF\4\0\0\0WEBP"));
    gltf["textures"][0]["extensions"]["EXT_texture_webp"] = {{"source", 1}};
    const auto look = look_of(gltf);
    ASSERT_TRUE(look) << detail_of(look);
    EXPECT_EQ(look->textures.at(0).texels.at(0)[0], 50);
    EXPECT_TRUE(look->notes.empty());
}

TEST(GltfPicture, ThatIsOnlyAWebPOrKtx2IsDroppedAndNoted)
{
    for (const char* extension : {"EXT_texture_webp", "KHR_texture_basisu"}) {
        Json gltf = showing(image("?"));
        gltf["textures"][0] = {{"extensions", {{extension, {{"source", 0}}}}}};
        const auto look = look_of(gltf);
        ASSERT_TRUE(look) << detail_of(look);
        EXPECT_FALSE(look->maps.at(0).any());
        ASSERT_EQ(look->notes.size(), 1U);
    }
}

TEST(GltfPicture, OfAnotherFormatIsRefusedByName)
{
    using namespace std::string_literals;
    for (const auto& [bytes, name] : {std::pair{"RIFF\x10\0\0\0WEBPVP8 "s, "image/webp"},
                                      {"\xABKTX 20\xBB\r\n\x1A\n"s, "image/ktx2"},
                                      {"\0\0\0\x1C"s + "ftypavif", "image/avif"},
                                      {"GIF89a\1\0\1\0"s, "image/gif"},
                                      {"BM\x3A\0\0\0"s, "neither"},
                                      {"#?RADIANCE\n"s, "neither"},
                                      {"\x89PNG"s, "neither"},
                                      {""s, "neither"}}) {
        const auto refused = decoded(bytes);
        ASSERT_FALSE(refused) << name;
        EXPECT_EQ(refused.error().fault, Fault::NotAvailable);
        EXPECT_NE(refused.error().detail.find(name), std::string::npos) << refused.error().detail;
        EXPECT_NE(refused.error().detail.find("/images/0"), std::string::npos);
    }
}

TEST(GltfPicture, CutShortAnywhereIsRefusedWithItsPlace)
{
    // A PNG's last four bytes are the checksum of an end that holds nothing.
    for (const auto& [whole, spare] :
         {std::pair{png(16, 16, 3, gradient()), 4U}, {jpeg(16, 16, 3, gradient()), 0U}}) {
        ASSERT_TRUE(decoded(whole));
        for (std::size_t size = 0; size < whole.size() - spare; ++size) {
            const auto refused = decoded(std::string_view(whole).substr(0, size));
            ASSERT_FALSE(refused) << size;
            EXPECT_NE(refused.error().detail.find("/images/0"), std::string::npos);
        }
    }
    const auto look = look_of(showing(image(png(16, 16, 3, gradient()).substr(0, 60))));
    ASSERT_FALSE(look);
    EXPECT_EQ(look.error().fault, Fault::MalformedBody);
    EXPECT_NE(look.error().detail.find("/images/0"), std::string::npos);
}

TEST(GltfPicture, OfAJpegWithAThumbnailStillNeedsItsOwnEnd)
{
    const std::string whole = jpeg(16, 16, 3, gradient());
    const std::string thumbnail = jpeg(1, 1, 3, {1, 2, 3});
    const auto length = static_cast<std::uint32_t>(thumbnail.size() + 2);
    std::string segment = "\xFF\xE1";  // APP1, where Exif lies
    segment += {static_cast<char>(length >> 8U), static_cast<char>(length & 0xFFU)};
    const std::string with = whole.substr(0, 2) + segment + thumbnail + whole.substr(2);
    EXPECT_TRUE(decoded(with));
    EXPECT_FALSE(decoded(std::string_view(with).substr(0, with.size() - 2)));
}

TEST(GltfPicture, LargerThanAllowedIsRefusedBeforeItIsDecoded)
{
    EXPECT_TRUE(decoded(png(4, 3, 1, std::vector<std::uint8_t>(12)), 12));
    EXPECT_EQ(decoded(png(4, 3, 1, std::vector<std::uint8_t>(12)), 11).error().fault,
              Fault::OutOfRange);
    const std::string small = png(1, 1, 3, {1, 2, 3});  // width at byte 16, height at 20
    for (const auto& [width, height] : {std::pair{100'000U, 100'000U},
                                        {0xFFFFFFFFU, 0xFFFFFFFFU},
                                        {0x80000000U, 2U},
                                        {1U, 0x7FFFFFFFU}}) {
        const auto refused = decoded(patched(patched(small, 16, width), 20, height), 1ULL << 25U);
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().fault, Fault::OutOfRange) << refused.error().detail;
    }
    EXPECT_EQ(decoded(patched(small, 16, 0)).error().fault, Fault::MalformedBody);
    // More than its data have: refused, whatever is allowed.
    EXPECT_FALSE(decoded(patched(small, 16, 5000), ~0ULL));
    EXPECT_EQ(decoded(jpeg(16, 16, 3, gradient()), 255).error().fault, Fault::OutOfRange);
}

TEST(GltfPicture, SharesWithTheOthersFourTimesWhatOneMayHave)
{
    Json gltf = gltf_with({{"materials", Json::array()}});
    for (std::size_t i = 0; i < 5; ++i) {
        gltf["images"].push_back(image(png(4, 4, 1, std::vector<std::uint8_t>(16))));
        gltf["textures"].push_back({{"source", i}});
        gltf["materials"].push_back({{"emissiveTexture", {{"index", i}}}});
    }
    const auto refused = look_of(gltf, 16);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().fault, Fault::OutOfRange);
    EXPECT_NE(refused.error().detail.find("/images/4"), std::string::npos);
    gltf["materials"].erase(4);
    EXPECT_TRUE(look_of(gltf, 16));
}

TEST(GltfPicture, ReferredToByAWrongIndexIsRefusedWhereItIsAskedFor)
{
    Json no_image = showing(image(dot(1)));
    no_image["textures"][0]["source"] = 1;
    EXPECT_NE(detail_of(look_of(no_image)).find("/textures/0/source"), std::string::npos);
    Json no_sampler = showing(image(dot(1)));
    no_sampler["textures"][0]["sampler"] = 0;
    EXPECT_NE(detail_of(look_of(no_sampler)).find("/textures/0/sampler"), std::string::npos);
    Json no_view = showing({{"bufferView", 0}, {"mimeType", "image/png"}});
    EXPECT_NE(detail_of(look_of(no_view)).find("/images/0"), std::string::npos);
    Json outside = showing({{"uri", "../../etc/picture.png"}});
    EXPECT_EQ(look_of(outside).error().fault, Fault::NotAvailable);
    Json no_texture = showing(image(dot(1)));
    no_texture["textures"] = {17};
    EXPECT_FALSE(look_of(no_texture));
}

TEST(GltfPicture, WithSpoiltBytesIsEitherAPictureOrRefused)
{
    std::mt19937 random(4);
    for (const std::string& whole : {png(16, 16, 3, gradient()), jpeg(16, 16, 3, gradient())}) {
        for (int i = 0; i < 2000; ++i) {
            std::string bytes = whole;
            for (unsigned n = 1 + random() % 4; n > 0; --n) {
                bytes[random() % bytes.size()] = static_cast<char>(random() % 256);
            }
            const auto picture = decoded(bytes, 1U << 16U);
            if (picture) {
                EXPECT_EQ(picture->texels.size(), static_cast<std::size_t>(picture->width) *
                                                      static_cast<std::size_t>(picture->height));
            }
        }
    }
}

}  // namespace
}  // namespace relight::test
