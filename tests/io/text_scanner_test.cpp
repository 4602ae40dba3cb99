#include "core/io/text_scanner.h"

#include <gtest/gtest.h>

namespace relight {
namespace {

std::span<const std::byte> bytes(std::string_view text)
{
    return std::as_bytes(std::span(text));
}

TEST(ParseReal, TakesEveryDecimalFormAndNoOther)
{
    for (const auto& [word, value] : {std::pair{"1", 1.0},
                                      {"+1", 1.0},
                                      {"1.", 1.0},
                                      {".5", 0.5},
                                      {"-.5", -0.5},
                                      {"1E+05", 1e5},
                                      {"1e5", 1e5},
                                      {"007", 7.0},
                                      {"1e-400", 0.0},
                                      {"1e-99999999999999999999", 0.0}}) {
        const Number<double> number = parse_real(word);
        EXPECT_TRUE(number) << word;
        EXPECT_EQ(number.value, value) << word;
    }
    EXPECT_TRUE(std::signbit(parse_real("-0").value));
    for (const char* word : {"", "+", "-", ".", "+-1", "--1", "1e", "0x10", "1,5", "1.5f", "e5"}) {
        EXPECT_EQ(parse_real(word).kind, NumberKind::Malformed) << word;
    }
    for (const char* word : {"nan", "NaN", "-nan", "inf", "-Infinity", "1.#INF", "-1.#IND"}) {
        EXPECT_EQ(parse_real(word).kind, NumberKind::NonFinite) << word;
    }
    for (const char* word : {"1e400", "-1e400", "1e99999999999999999999"}) {
        EXPECT_EQ(parse_real(word).kind, NumberKind::OutOfRange) << word;
    }
    EXPECT_EQ(parse_real(std::string(400, '9')).kind, NumberKind::OutOfRange);
    EXPECT_EQ(parse_real("0." + std::string(400, '0') + "1").value, 0.0);
}

TEST(ParseInteger, RefusesWhatIsNotWholeOrDoesNotFit)
{
    EXPECT_EQ(parse_integer("-12").value, -12);
    EXPECT_EQ(parse_integer("+12").value, 12);
    for (const char* word : {"", "1.0", "1e3", "+-1", "0x1", "1 "}) {
        EXPECT_EQ(parse_integer(word).kind, NumberKind::Malformed) << word;
    }
    EXPECT_EQ(parse_integer("99999999999999999999").kind, NumberKind::OutOfRange);
}

TEST(TextScanner, CountsLinesOfEveryKind)
{
    TextScanner scanner(bytes("a\nb\r\nc\rd \t e\n\r\n\nf"));
    std::string seen;
    for (std::string_view word; !(word = scanner.word_on_any_line()).empty();) {
        seen += std::string(word) + std::to_string(scanner.line()) + " ";
    }
    EXPECT_EQ(seen, "a1 b2 c3 d4 e4 f7 ");
    EXPECT_TRUE(scanner.at_end());
}

TEST(Shown, IsShortPrintableAndQuoted)
{
    EXPECT_EQ(shown("float16"), "'float16'");
    EXPECT_EQ(shown("a\x01\xff'b"), "'a???b'");
    EXPECT_LT(shown(std::string(1'000'000, 'x')).size(), 40U);
}

}  // namespace
}  // namespace relight
