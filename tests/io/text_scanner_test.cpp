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

TEST(TextScanner, APlainNumberIsWhatParseRealSaysOrNothing)
{
    for (const std::string word :
         {"1",     "-1.5", ".5",  "1.",   "-0",  "1e5", "1E-05",  "+1",     "1e16",
          "-1e16", "nan",  "inf", "1.0x", "1#2", "1e",  "1e400",  "1e-400", "1.#INF",
          "0x1",   "--1",  "1/2", "1e15", "a",   ".",   "3.1+e2", "00001",  "1\\"}) {
        for (const char* after : {"", " 7", "\t7", "\n7", "\r\n"}) {
            const std::string text = " " + word + after;
            TextScanner scanner(bytes(text));
            const auto plain = scanner.plain_real(1e15);
            const Number<double> number = parse_real(word);
            const bool allowed = number && std::abs(number.value) <= 1e15;
            if (plain) {
                EXPECT_TRUE(allowed) << text;
                EXPECT_EQ(*plain, number.value) << text;
                EXPECT_TRUE(scanner.at_line_end() || scanner.word() == "7") << text;
            } else {
                EXPECT_EQ(scanner.word(), word) << text;  // still there
                EXPECT_TRUE(!allowed || word == "+1" || word == "1e-400") << text;
            }
        }
    }
}

TEST(TextScanner, APlainCornerNamesUpToThreeIndicesFromOneUp)
{
    using Corner = std::array<std::uint32_t, 3>;
    const auto read = [](const std::string& text) -> std::optional<Corner> {
        TextScanner scanner(bytes(text));
        Corner corner{};
        if (scanner.plain_corner(corner)) { return corner; }
        EXPECT_EQ(scanner.word(), text.substr(0, text.find(' ')));  // still there
        return {};
    };
    EXPECT_EQ(read("7"), (Corner{7, 0, 0}));
    EXPECT_EQ(read("7/8"), (Corner{7, 8, 0}));
    EXPECT_EQ(read("7//9"), (Corner{7, 0, 9}));
    EXPECT_EQ(read("7/8/9 10"), (Corner{7, 8, 9}));
    EXPECT_EQ(read("999999999/0012\n"), (Corner{999'999'999, 12, 0}));
    for (const char* other : {"-1", "+1", "0", "7/0", "7/", "7//", "/7", "7/8/", "7///9", "7/8/9/",
                              "7/8/9x", "7x", "1000000000", "7//9#", "#", "7\\", "v"}) {
        EXPECT_FALSE(read(other)) << other;
    }
}

TEST(Shown, IsShortPrintableAndQuoted)
{
    EXPECT_EQ(shown("float16"), "'float16'");
    EXPECT_EQ(shown("a\x01\xff'b"), "'a???b'");
    EXPECT_LT(shown(std::string(1'000'000, 'x')).size(), 40U);
}

}  // namespace
}  // namespace relight
