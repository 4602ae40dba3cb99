#include "server/json_text.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace relight {
namespace {

TEST(JsonText, QuotesAnyBytesAsJsonThatReadsBack)
{
    std::string all;
    for (int c = 0; c < 128; ++c) { all += static_cast<char>(c); }
    all += "é—𝄞";
    EXPECT_EQ(nlohmann::json::parse(json_string(all)), all);
}

TEST(JsonText, ReplacesWhatIsNotUtf8)  // RFC 3629
{
    for (const std::string bad : {"\x80", "\xC3", "\xC0\xAF", "\xE0\x80\xAF", "\xED\xA0\x80",
                                  "\xF4\x90\x80\x80", "\xF5\x80\x80\x80", "\xFF"}) {
        const auto read = nlohmann::json::parse(json_string("a" + bad + "b")).get<std::string>();
        EXPECT_EQ(read.front(), 'a');
        EXPECT_EQ(read.back(), 'b');
        EXPECT_NE(read.find("\xEF\xBF\xBD"), std::string::npos);
    }
}

TEST(JsonText, WritesNumbersThatReadBackExactly)
{
    for (const double x : {0.1, 1.0 / 3.0, 1e300, -5e-324, 123456789.0, -0.0}) {
        EXPECT_EQ(std::strtod(decimal(x).c_str(), nullptr), x);
    }
    EXPECT_EQ(decimal(0.1), "0.1");
}

TEST(JsonText, ShowsClientsTextAsPrintableAsciiOnly)
{
    EXPECT_EQ(printable("a\nb\x1b[31m\xff"), "a?b?[31m?");
    EXPECT_EQ(printable("abcdef", 3), "abc…");
}

}  // namespace
}  // namespace relight
