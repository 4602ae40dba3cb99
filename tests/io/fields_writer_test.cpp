#include "core/io/fields_writer.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "core/display/display.h"

namespace relight {
namespace {

using nlohmann::json;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr FieldType types[] = {FieldType::Float32, FieldType::Float16, FieldType::UInt8};

template <class T>
std::vector<T> values_at(std::string_view bytes, std::size_t offset, std::size_t count)
{
    std::vector<T> values(count);
    EXPECT_LE(offset + count * sizeof(T), bytes.size());
    if (count > 0) { std::memcpy(values.data(), bytes.data() + offset, count * sizeof(T)); }
    return values;
}

/// A message taken apart as a client does.
struct Message {
    json head;
    std::string arrays;
};

Message taken_apart(const std::string& bytes)
{
    const std::uint32_t length = values_at<std::uint32_t>(bytes, 0, 1)[0];
    EXPECT_EQ((4 + length) % 8, 0U);
    Message message{json::parse(bytes.substr(4, length)), bytes.substr(4 + length)};
    EXPECT_EQ(message.head["bytes_total"], bytes.size());
    return message;
}

std::vector<float> noise(std::size_t count)
{
    std::mt19937 random(3);
    std::uniform_real_distribution<float> any(-2.0F, 2.0F);
    std::vector<float> values(count);
    for (float& x : values) { x = any(random); }
    return values;
}

TEST(EncodeFields, ASmallMessageIsTheseBytes)
{
    const std::vector<float> E{1.0F, -2.5F, 65505.0F, 1e9F, nan, 0.1F};
    const std::vector<Rgb8> color{{1, 2, 3}, {255, 0, 128}};
    const Encoding encoding =
        encode_fields(2,
                      {{"irradiance", FieldType::Float16, 3, E, "W/m2"},
                       {"color", FieldType::UInt8, 3, std::span<const Rgb8>(color), "sRGB"}},
                      R"("samples":16,"final":false)");
    std::string head =
        R"({"vertices":2,"fields":[)"
        R"({"name":"irradiance","type":"float16","components":3,"offset":0,"bytes":12,)"
        R"("unit":"W/m2","clamped":1},)"
        R"({"name":"color","type":"uint8","components":3,"offset":16,"bytes":6,"unit":"sRGB"}],)"
        R"("samples":16,"final":false,"bytes_total":304})";
    head.resize(276, ' ');  // where a total of 20 digits would have had its room
    std::string expected("\x14\x01\0\0", 4);
    expected += head;
    expected += std::string("\x00\x3C\x00\xC1\xFF\x7B\xFF\x7B\x00\x7E\x66\x2E\0\0\0\0", 16);
    expected += std::string("\x01\x02\x03\xFF\x00\x80\0\0", 8);
    EXPECT_EQ(whole(encoding), expected);
    EXPECT_EQ(encoding.bytes, expected.size());
}

TEST(EncodeFields, SizesPromisedAreSizesWrittenAndArraysAreWhereTheHeadSays)
{
    for (const std::size_t vertices : {0U, 1U, 2U, 3U, 1000U, 4099U, 70'001U}) {
        const std::vector<float> one = noise(vertices), three = noise(3 * vertices);
        const std::vector<Rgb8> color(vertices, {7, 8, 9});
        for (const FieldType a : types) {
            for (const FieldType b : types) {
                SCOPED_TRACE(std::string(name_of(a)) + ' ' + std::string(name_of(b)) + ' ' +
                             std::to_string(vertices));
                const Encoding encoding = encode_fields(
                    vertices, {{"one", a, 1, one, "1"},
                               {"color", FieldType::UInt8, 3, std::span<const Rgb8>(color), "sRGB"},
                               {"three", b, 3, three, "W/m2"}});
                const std::string bytes = whole(encoding);
                ASSERT_EQ(bytes.size(), encoding.bytes);
                EXPECT_EQ(whole(encoding), bytes) << "a second time";
                const auto [head, arrays] = taken_apart(bytes);
                EXPECT_EQ(head["vertices"], vertices);
                ASSERT_EQ(head["fields"].size(), 3U);
                std::size_t end = 0;
                for (const json& field : head["fields"]) {
                    EXPECT_EQ(field["offset"], (end + 7) / 8 * 8);
                    end = field["offset"].get<std::size_t>() + field["bytes"].get<std::size_t>();
                }
                EXPECT_EQ(arrays.size(), (end + 7) / 8 * 8);
                const std::size_t at = head["fields"][2]["offset"];
                if (b == FieldType::Float32) {
                    EXPECT_EQ(values_at<float>(arrays, at, 3 * vertices), three);
                }
                EXPECT_EQ(values_at<Rgb8>(arrays, head["fields"][1]["offset"], vertices), color);
            }
        }
    }
}

TEST(EncodeFields, MessagesFollowOneAnother)
{
    const std::vector<float> E = noise(30);
    std::string stream;
    for (const FieldType type : types) {
        stream += whole(encode_fields(10, {{"E", type, 3, E, "lx"}}));
    }
    for (const FieldType type : types) {
        const std::uint32_t length = values_at<std::uint32_t>(stream, 0, 1)[0];
        const std::size_t total = json::parse(stream.substr(4, length))["bytes_total"];
        EXPECT_EQ(total % 8, 0U);
        EXPECT_EQ(taken_apart(stream.substr(0, total)).head["fields"][0]["type"], name_of(type));
        stream.erase(0, total);
    }
    EXPECT_TRUE(stream.empty());
}

TEST(EncodeFields, AnyTextIsANameAndOnlyAName)
{
    const std::string name = "visibility/\"käse\",\n{\x01";
    const Message message = taken_apart(whole(encode_fields(0, {{name, types[0], 1, {}, "\""}})));
    EXPECT_EQ(message.head["fields"][0]["name"], name);
    EXPECT_EQ(message.head["fields"][0]["unit"], "\"");
    EXPECT_EQ(message.head.size(), 3U);
    EXPECT_TRUE(taken_apart(whole(encode_fields(5, {}))).head["fields"].empty());
}

TEST(EncodeFields, SharesBecomeTheNearestOf255)
{
    std::vector<float> shares{nan, infinity, -infinity, -1.0F, 2.0F, -0.0F, 1.0F};
    for (int code = 0; code < 255; ++code) {  // where one code ends and the next begins
        const float step = (static_cast<float>(code) + 0.5F) / 255.0F;
        for (const float x : {std::nextafter(step, 0.0F), step, std::nextafter(step, 1.0F)}) {
            shares.push_back(x);
        }
    }
    for (const float x : noise(10'000)) { shares.push_back(x); }
    const std::string bytes =
        whole(encode_fields(shares.size(), {{"v", FieldType::UInt8, 1, shares, "1"}}));
    const auto codes = values_at<unsigned char>(taken_apart(bytes).arrays, 0, shares.size());
    for (std::size_t i = 0; i < shares.size(); ++i) {
        ASSERT_EQ(codes[i], to_code(static_cast<double>(shares[i]))) << shares[i];
    }
}

TEST(EncodeFields, CountsWhatBinary16CannotHold)
{
    const std::vector<float> E{65504.0F,  65519.996F, -65519.996F, 65520.0F,
                               -65520.0F, infinity,   -infinity,   nan};
    const json head =
        taken_apart(whole(encode_fields(8, {{"E", FieldType::Float16, 1, E, "lx"}}))).head;
    EXPECT_EQ(head["fields"][0]["clamped"], 4);
}

TEST(FieldType, HasANameEach)
{
    for (const FieldType type : types) { EXPECT_EQ(field_type(name_of(type)), type); }
    EXPECT_EQ(field_type("float64"), std::nullopt);
    EXPECT_EQ(field_type(""), std::nullopt);
}

}  // namespace
}  // namespace relight
