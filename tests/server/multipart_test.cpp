#include "server/multipart.h"

#include <gtest/gtest.h>

namespace relight {
namespace {

const std::string good_body =
    "--XyZ\r\nContent-Disposition: form-data; name=\"request\"\r\n\r\n{}\r\n"
    "--XyZ\r\nContent-Disposition: form-data; name=\"mesh\"; filename=\"a \\\"b\\\".ply\"\r\n"
    "Content-Type: application/octet-stream\r\n\r\nply\r\n--XyW\r\n\r\n--Xy\r\n--XyZ--\r\n";

Result<std::vector<Part>> parse(const std::string& body, std::size_t step = 1000,
                                const MultipartLimits& limits = {})
{
    MultipartParser parser("XyZ", limits);
    for (std::size_t i = 0; i < body.size(); i += step) {
        if (!parser.feed(std::string_view(body).substr(i, step))) { break; }
    }
    return std::move(parser).finish();
}

TEST(Multipart, GivesThePartsHoweverTheBytesArrive)
{
    for (const std::size_t step : {1U, 2U, 3U, 7U, 1000U}) {
        const auto parts = parse(good_body, step);
        ASSERT_TRUE(parts) << step;
        ASSERT_EQ(parts->size(), 2U);
        EXPECT_EQ((*parts)[0].name, "request");
        EXPECT_EQ((*parts)[0].data, "{}");
        EXPECT_EQ((*parts)[1].name, "mesh");
        EXPECT_EQ((*parts)[1].content_type, "application/octet-stream");
        EXPECT_EQ((*parts)[1].data, "ply\r\n--XyW\r\n\r\n--Xy") << "near delimiters are data";
    }
}

TEST(Multipart, EveryCutBodyIsRefused)
{
    const std::size_t closing = good_body.rfind("--\r\n");
    for (std::size_t size = 0; size < closing + 2; ++size) {
        const auto parts = parse(good_body.substr(0, size));
        ASSERT_FALSE(parts) << size;
        EXPECT_EQ(parts.error().fault, Fault::BadRequest);
    }
}

TEST(Multipart, RefusesWhatIsNotAPart)
{
    const std::string end = "\r\n--XyZ--\r\n";
    const std::string head = "--XyZ\r\nContent-Disposition: form-data; ";
    const std::vector<std::string> bodies = {
        "hello\r\n" + good_body,             // a preamble
        "--XyZ\n" + end,                     // a bare line end
        "--XyZabc\r\n\r\n" + end,            // text after the delimiter
        "--XyZ\r\n\r\nx" + end,              // no header
        "--XyZ\r\nno colon\r\n\r\nx" + end,  //
        "--XyZ\r\nContent-Disposition: attachment; name=\"a\"\r\n\r\nx" + end,
        head + "filename=\"a\"\r\n\r\nx" + end,          // no name
        head + "name=\"\"\r\n\r\nx" + end,               // an empty one
        head + "name=\"a\r\n\r\nx" + end,                // no closing quote
        head + "name=\"a\"; name=\"b\"\r\n\r\nx" + end,  // two names
        head + "name=\"" + std::string(129, 'a') + "\"\r\n\r\nx" + end,
        head + "name=a\r\nX: " + std::string(5000, 'a') + "\r\n\r\nx" + end,
        head + "name=a\r\n\r\nx\r\n" + head + "name=a\r\n\r\nx" + end,  // twice
    };
    for (const std::string& body : bodies) {
        const auto parts = parse(body);
        ASSERT_FALSE(parts) << body.substr(0, 80);
        EXPECT_EQ(parts.error().fault, Fault::BadRequest);
    }
    EXPECT_EQ(
        parse(head + "name=a\r\nContent-Transfer-Encoding: base64\r\n\r\nx" + end).error().fault,
        Fault::UnsupportedEncoding);
}

TEST(Multipart, KeepsItsBounds)
{
    std::string many;
    for (int i = 0; i < 17; ++i) {
        many +=
            "--XyZ\r\nContent-Disposition: form-data; name=p" + std::to_string(i) + "\r\n\r\n\r\n";
    }
    EXPECT_EQ(parse(many + "--XyZ--").error().fault, Fault::BadRequest);
    MultipartLimits small;
    small.request_bytes = 1;
    EXPECT_EQ(parse(good_body, 1000, small).error().fault, Fault::BodyTooLarge);
}

TEST(Multipart, ABoundaryIsThatOfRfc2046)
{
    EXPECT_EQ(multipart_boundary("multipart/form-data; boundary=abc"), "abc");
    EXPECT_EQ(multipart_boundary("Multipart/Form-Data; charset=utf-8; boundary=\"a b\""), "a b");
    for (const std::string bad :
         {"multipart/form-data", "multipart/form-data; boundary=", "multipart/mixed; boundary=a",
          "multipart/form-data; boundary=\"a\r\nb\"", "multipart/form-data; boundary=\"a ",
          "multipart/form-data; boundary=a; boundary=b"}) {
        EXPECT_FALSE(multipart_boundary(bad)) << bad;
    }
    EXPECT_FALSE(multipart_boundary("multipart/form-data; boundary=" + std::string(71, 'a')));
}

}  // namespace
}  // namespace relight
