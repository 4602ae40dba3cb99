#include "server/negotiate.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace relight
