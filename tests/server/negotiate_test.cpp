#include "server/negotiate.h"

#include <gtest/gtest.h>
#include <zlib.h>

namespace relight {
namespace {

TEST(Negotiate, TakesTheFormatOfGreatestWeight)  // RFC 9110, 12.5.1
{
    EXPECT_EQ(format_accepted(""), Format::Ply);
    EXPECT_EQ(format_accepted("*/*"), Format::Ply);
    EXPECT_EQ(format_accepted("application/json"), Format::Json);
    EXPECT_EQ(format_accepted("image/*"), Format::Png);
    EXPECT_EQ(format_accepted("image/x-exr, image/png;q=0.9"), Format::Exr);
    EXPECT_EQ(format_accepted("image/png;q=0, image/*;q=0.5"), Format::Exr);
    EXPECT_EQ(format_accepted("application/json;q=0.5, image/png;q=0.8"), Format::Png);
    EXPECT_EQ(format_accepted("text/html, application/x-npz;q=0.2"), Format::Npz);
    EXPECT_EQ(format_accepted("application/json, */*;q=0.1"), Format::Json);
    EXPECT_EQ(format_accepted("model/ply;q=0, application/octet-stream;q=0, */*;q=0.1"),
              Format::Json);
    EXPECT_FALSE(format_accepted("text/html"));
    EXPECT_FALSE(format_accepted("application/json;q=0"));
}

TEST(Negotiate, SendsEachFormatAsATypeThatAsksForIt)
{
    for (const Format format : {Format::Ply, Format::Json, Format::Npz, Format::Png, Format::Exr}) {
        EXPECT_EQ(format_accepted(media_type(format)), format) << media_type(format);
    }
    EXPECT_EQ(media_type(Format::PlyAscii), media_type(Format::Ply));
}

TEST(Negotiate, SeesWhoTakesGzip)
{
    EXPECT_TRUE(accepts_gzip("gzip, deflate, br"));
    EXPECT_TRUE(accepts_gzip("*"));
    EXPECT_FALSE(accepts_gzip(""));
    EXPECT_FALSE(accepts_gzip("br, gzip;q=0"));
    EXPECT_FALSE(accepts_gzip("identity"));
}

TEST(Negotiate, GzipReadsBack)
{
    for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{3'000'000}}) {
        std::string text(size, ' ');
        for (std::size_t i = 0; i < size; ++i) {
            text[i] = static_cast<char>('0' + i * i % 61 % 10);
        }
        const std::string packed = gzip(text);
        std::string out(size + 1, ' ');
        z_stream stream = {};
        ASSERT_EQ(inflateInit2(&stream, 31), Z_OK);
        stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
        stream.avail_in = static_cast<uInt>(packed.size());
        stream.next_out = reinterpret_cast<Bytef*>(out.data());
        stream.avail_out = static_cast<uInt>(out.size());
        EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
        out.resize(stream.total_out);
        inflateEnd(&stream);
        EXPECT_EQ(out, text);
    }
}

}  // namespace
}  // namespace relight
