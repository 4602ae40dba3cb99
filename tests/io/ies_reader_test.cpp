#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/light/ies.h"
#include "tests/io/mutants.h"
#include "tests/io/photometry_checks.h"
#include "tests/oracle.h"

namespace relight::test {
namespace {

const std::string data = RELIGHT_TEST_DATA;

/// A file of two vertical and one horizontal angle, in parts that a test may replace.
struct Parts {
    std::string labels = "IESNA:LM-63-2002\n[TEST] X\n";
    std::string tilt = "TILT=NONE\n";
    std::string lamp = "1 1000 1 2 1 1 2 0 0 0\n";
    std::string ballast = "1 1 50\n";
    std::string vertical = "0 90\n";
    std::string horizontal = "0\n";
    std::string candela = "10 20\n";
    std::string rest;

    std::string text() const
    {
        return labels + tilt + lamp + ballast + vertical + horizontal + candela + rest;
    }
};

bool same(const IesProfile& a, const IesProfile& b)
{
    return a.vertical_deg == b.vertical_deg && a.horizontal_deg == b.horizontal_deg &&
           a.candela == b.candela;
}

/// The number `label` of the lamp line (from 0) replaced.
Parts with_lamp(std::size_t place, const std::string& word)
{
    std::vector<std::string> words{"1", "1000", "1", "2", "1", "1", "2", "0", "0", "0"};
    words[place] = word;
    Parts parts;
    parts.lamp.clear();
    for (const std::string& w : words) { parts.lamp += w + (&w == &words.back() ? '\n' : ' '); }
    return parts;
}

TEST(IesReader, ReadsEverySampleWithTheNumbersOfItsSource)  // tests/data/SOURCES.md
{
    struct Row {
        const char* file;
        std::size_t vertical;
        double last_vertical, least, most, factor;
    };
    const Row rows[] = {{"bega_6339_wall", 73, 180, 0.07175, 178.4, 0.89},
                        {"erco_stella_lm63_1986", 19, 90, 0.01425, 6526, 4.8},
                        {"bitreign_01", 91, 90, 1, 102.5, 1},
                        {"bitreign_07", 91, 90, 3.429, 26.18, 1}};
    for (const Row& row : rows) {
        const auto profile = ies(contents(data + "/ies/" + row.file + ".ies"));
        ASSERT_TRUE(profile) << row.file << ": " << profile.error().detail;
        EXPECT_EQ(profile->vertical_deg.size(), row.vertical) << row.file;
        EXPECT_EQ(profile->vertical_deg.front(), 0.0) << row.file;
        EXPECT_EQ(profile->vertical_deg.back(), row.last_vertical) << row.file;
        EXPECT_EQ(profile->horizontal_deg, std::vector<double>{0.0}) << row.file;
        const auto [least, most] =
            std::minmax_element(profile->candela.begin(), profile->candela.end());
        EXPECT_NEAR(*least, row.least * row.factor, 5e-4 * row.least * row.factor) << row.file;
        EXPECT_NEAR(*most, row.most * row.factor, 5e-4 * row.most * row.factor) << row.file;
    }
}

TEST(IesReader, AgreesWithTheFluxOfEveryProfileOfTheOracle)
{
    const nlohmann::json file = oracle("lights_ies");
    std::size_t checked = 0;
    for (const auto& c : file.at("cases")) {
        if (!c.contains("total_flux_lm")) { continue; }
        for (const auto& p : file.at("profiles")) {
            if (p.at("name") != c.at("profile")) { continue; }
            const auto profile = ies(p.at("text").get<std::string>());
            ASSERT_TRUE(profile) << p.at("name") << ": " << profile.error().detail;
            const double expected = c.at("total_flux_lm").get<double>();
            EXPECT_NEAR(flux(*profile), expected, 1e-6 * expected) << p.at("name");
            ++checked;
        }
    }
    EXPECT_EQ(checked, file.at("profiles").size());
}

TEST(IesReader, ReadsEveryYearsHeader)
{
    const auto expected = ies(Parts{}.text());
    ASSERT_TRUE(expected) << expected.error().detail;
    EXPECT_EQ(expected->candela, (std::vector<double>{10, 20}));
    for (const char* labels :
         {"", "Some lamp of 1986\nof two lines\n\n", "IESNA91\n[TEST] a\n", "IESNA:LM-63-1995\n",
          "IESNA:\n", "\xEF\xBB\xBFIESNA:LM-63-2002\n[MORE] TILT=x is no line of its own\n"}) {
        Parts parts;
        parts.labels = labels;
        const auto profile = ies(parts.text());
        ASSERT_TRUE(profile) << labels << ": " << profile.error().detail;
        EXPECT_TRUE(same(*profile, *expected)) << labels;
    }
}

TEST(IesReader, TakesAnyBlanksCommasAndLineEndsBetweenNumbers)
{
    const auto expected = ies(Parts{}.text());
    std::string one_a_line, commas, carriage_returns;
    for (const char c : Parts{}.text()) {
        one_a_line += c == ' ' ? "\r\n\t" : std::string(1, c);
        commas += c == ' ' ? std::string(" , ") : std::string(1, c);
        carriage_returns += c == '\n' ? '\r' : c;
    }
    Parts glued;
    glued.ballast = "1,1,50\n0,\n,90,0,";
    glued.vertical = glued.horizontal = "";
    for (const std::string& text :
         {one_a_line, commas, carriage_returns, glued.text(), Parts{}.text() + " ,\r\n\x1A"}) {
        const auto profile = ies(text);
        ASSERT_TRUE(profile) << text << ": " << profile.error().detail;
        EXPECT_TRUE(same(*profile, *expected)) << text;
    }
}

TEST(IesReader, MultipliesCandelaByMultiplierAndBallastFactorAlone)
{
    Parts parts = with_lamp(2, "2.5");
    parts.ballast = "0.8 7 50\n";  // the factor kept for future use and the watts change nothing
    EXPECT_EQ(ies(parts.text())->candela, (std::vector<double>{20, 40}));
    parts = with_lamp(0, "4");
    EXPECT_EQ(ies(parts.text())->candela, (std::vector<double>{10, 20}));
}

TEST(IesReader, PassesOverIncludedTilt)
{
    Parts parts;
    parts.tilt = "TILT= INCLUDE \n1\n3\n0 45 90\n1 .9 .8\n";
    const auto profile = ies(parts.text());
    ASSERT_TRUE(profile) << profile.error().detail;
    EXPECT_TRUE(same(*profile, *ies(Parts{}.text())));
}

TEST(IesReader, TakesEveryRangeOfAnglesThatTheStandardKnows)
{
    for (const char* vertical : {"0 90", "90 180", "0 180"}) {
        for (const char* horizontal : {"0 90", "0 180", "0 360", "90 270"}) {
            Parts parts = with_lamp(4, "2");
            parts.vertical = vertical + std::string("\n");
            parts.horizontal = horizontal + std::string("\n");
            parts.candela = "1 2 3 4\n";
            EXPECT_TRUE(ies(parts.text())) << vertical << " / " << horizontal;
        }
    }
}

TEST(IesReader, RefusesEachBrokenFileAndSaysWhere)
{
    const auto with = [](std::string Parts::*part, const std::string& text) {
        Parts parts;
        parts.*part = text;
        return parts;
    };
    const auto horizontal = [](const char* angles) {
        Parts parts = with_lamp(4, "2");
        parts.horizontal = angles;
        parts.candela = "1 2 3 4\n";
        return parts;
    };
    struct Case {
        std::string file;
        Fault fault;
        const char* says;
        std::uint64_t line;
    };
    const Case cases[] = {
        {"", Fault::EmptyFile, "no bytes", 0},
        {"IESNA:LM-63-1995\nno tilt\n", Fault::MalformedHeader, "TILT=", 3},
        {with(&Parts::tilt, "TILT=lamp.tlt\n").text(), Fault::NotAvailable, "'lamp.tlt'", 3},
        {with(&Parts::tilt, "TILT=\n").text(), Fault::NotAvailable, "''", 3},
        {with(&Parts::tilt, "TILT=INCLUDE\n1 99999\n").text(), Fault::CountExceedsFile,
         "tilt angles", 4},
        {with(&Parts::tilt, "TILT=INCLUDE\n1 -1\n").text(), Fault::MalformedBody, "tilt angles", 4},
        {with_lamp(5, "2").text(), Fault::NotAvailable, "type B", 4},
        {with_lamp(5, "3").text(), Fault::NotAvailable, "type A", 4},
        {with_lamp(5, "4").text(), Fault::MalformedBody, "1 (C)", 4},
        {with_lamp(2, "-1").text(), Fault::OutOfRange, "candela multiplier", 4},
        {with_lamp(2, "nan").text(), Fault::OutOfRange, "candela multiplier", 4},
        {with_lamp(2, "x").text(), Fault::MalformedBody, "'x' is no number", 4},
        {with_lamp(3, "1").text(), Fault::MalformedBody, "2 or more", 4},
        {with_lamp(3, "2.5").text(), Fault::MalformedBody, "whole number", 4},
        {with_lamp(4, "0").text(), Fault::MalformedBody, "1 or more", 4},
        {with_lamp(4, "-3").text(), Fault::MalformedBody, "1 or more", 4},
        {with_lamp(3, "1e18").text(), Fault::CountExceedsFile, "bytes", 4},
        {with_lamp(4, "12").text(), Fault::CountExceedsFile, "2 x 12", 4},
        {with(&Parts::ballast, "-1 1 50\n").text(), Fault::OutOfRange, "ballast factor", 5},
        {with(&Parts::vertical, "0 80\n").text(), Fault::OutOfRange, "0 to 90, 90 to 180", 6},
        {with(&Parts::vertical, "10 90\n").text(), Fault::OutOfRange, "0 to 90, 90 to 180", 6},
        {with(&Parts::vertical, "-90 90\n").text(), Fault::OutOfRange, "0 to 90, 90 to 180", 6},
        {with(&Parts::vertical, "90 0\n").text(), Fault::MalformedBody, "vertical angle 2", 6},
        {with(&Parts::vertical, "90 90\n").text(), Fault::MalformedBody, "vertical angle 2", 6},
        {with(&Parts::horizontal, "90\n").text(), Fault::OutOfRange, "90 to 270", 7},
        {horizontal("0 45\n").text(), Fault::OutOfRange, "90 to 270", 7},
        {horizontal("90 180\n").text(), Fault::OutOfRange, "90 to 270", 7},
        {horizontal("0 345\n").text(), Fault::OutOfRange, "0 to 360", 7},
        {horizontal("90 0\n").text(), Fault::MalformedBody, "horizontal angle 2", 7},
        {with(&Parts::candela, "10 -20\n").text(), Fault::OutOfRange, "value 2", 8},
        {with(&Parts::candela, "10 1e31\n").text(), Fault::OutOfRange, "value 2", 8},
        {with(&Parts::candela, "10 1e999\n").text(), Fault::OutOfRange, "'1e999'", 8},
        {with(&Parts::candela, "10 inf\n").text(), Fault::OutOfRange, "'inf'", 8},
        {with(&Parts::candela, "10\n").text(), Fault::Truncated, "candela value", 9},
        {with(&Parts::rest, "30\n").text(), Fault::MalformedBody, "'30' follows", 9},
        {contents(data + "/broken/a_ies_negative_counts.ies"), Fault::MalformedBody, "2 or more",
         4},
        {contents(data + "/broken/a_ies_table_too_short.ies"), Fault::CountExceedsFile,
         "vertical angles is more", 4},
    };
    for (const Case& c : cases) {
        const auto profile = ies(c.file);
        ASSERT_FALSE(profile) << c.file;
        EXPECT_EQ(profile.error().fault, c.fault) << c.file << ": " << profile.error().detail;
        EXPECT_NE(profile.error().detail.find(c.says), std::string::npos)
            << c.file << ": " << profile.error().detail;
        EXPECT_EQ(profile.error().line.value_or(0), c.line) << c.file;
    }
}

TEST(IesReader, StopsWhenTold)
{
    Progress progress;
    progress.stop();
    const std::string text = Parts{}.text();
    EXPECT_EQ(read_ies(std::as_bytes(std::span(text)), progress).error().fault, Fault::Cancelled);
}

TEST(IesReader, KeepsItsPromisesOnBrokenText)
{
    const auto check = [](std::string_view mutant) { return broken_promise(read_ies, mutant); };
    Parts parts = with_lamp(4, "3");
    parts.tilt = "TILT=INCLUDE\n1\n2\n0 90\n1 .8\n";
    parts.horizontal = "0 45 90\n";
    parts.candela = "1 2,3 4 5 6\n";
    EXPECT_EQ(broken_promise_of_mutants(check, parts.text(), 20'000, 1), "");
    EXPECT_EQ(broken_promise_of_mutants(check, contents(data + "/ies/bega_6339_wall.ies"), 3000, 2),
              "");
}

}  // namespace
}  // namespace relight::test
