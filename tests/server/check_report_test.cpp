#include "server/check_report.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <sstream>

namespace relight {
namespace {

const std::vector<CheckCase> three{
    {"first", "point", "E = I / h^2", "W/m2", 2.0, 2.0, 1e-6, "relative 5e-07"},
    {"second", "point", "E = 0", "W/m2", 0.0, 1.0, 0.0, "exact"},
    {"third of a longer name", "D", "int D = 1", "1", 1.0, std::numeric_limits<double>::quiet_NaN(),
     1e-6, "relative 1e-06"}};

TEST(CheckReport, CountsWhatFails)
{
    EXPECT_EQ(failures(three), 2U);
    EXPECT_EQ(failures(std::span(three).first(1)), 0U);
}

TEST(CheckReport, TheJsonHoldsEveryCaseAndNullWhereThereIsNoNumber)
{
    const std::string json = check_json(three, "1.2.3");
    EXPECT_TRUE(json.starts_with(R"({"version":"1.2.3","kernel":"Embree)")) << json;
    EXPECT_NE(json.find(R"("passed":1,"failed":2,"cases":[{)"), std::string::npos) << json;
    EXPECT_NE(json.find(R"({"name":"second","group":"point","formula":"E = 0","unit":"W/m2",)"
                        R"("expected":0,"computed":1,"error":1,"tolerance":0,)"
                        R"("tolerance_kind":"exact","pass":false})"),
              std::string::npos)
        << json;
    EXPECT_NE(json.find(R"("computed":null,"error":null)"), std::string::npos) << json;
    EXPECT_EQ(json.find("nan"), std::string::npos);
}

TEST(CheckReport, TheTableHasAHeadingAGroupAndALineACaseInColumns)
{
    const std::string table = check_table(three, "1.2.3", false);
    EXPECT_EQ(table.find('\033'), std::string::npos);
    std::istringstream text(table);
    std::vector<std::string> lines;
    for (std::string line; std::getline(text, line);) { lines.push_back(line); }
    ASSERT_EQ(lines.size(), 8U) << table;  // titles, 2 groups, 3 cases, an empty line, the summary
    EXPECT_EQ(lines[1], "point");
    EXPECT_EQ(lines[4], "D");
    EXPECT_TRUE(lines[2].starts_with("  ok  first")) << table;
    EXPECT_TRUE(lines[3].starts_with("FAIL  second")) << table;
    EXPECT_TRUE(lines[5].starts_with("FAIL  third of a longer name")) << table;
    EXPECT_EQ(lines[2].find("E = I / h^2"), lines[3].find("E = 0")) << table;
    EXPECT_EQ(lines[0].find("formula"), lines[3].find("E = 0")) << table;
    EXPECT_TRUE(lines[7].starts_with("1 passed, 2 failed (relight 1.2.3, Embree")) << table;
}

TEST(CheckReport, ATerminalSeesColours)
{
    const std::string table = check_table(three, "1.2.3", true);
    EXPECT_NE(table.find("\033[31mFAIL\033[0m"), std::string::npos);
    EXPECT_NE(table.find("\033[32m  ok\033[0m"), std::string::npos);
}

}  // namespace
}  // namespace relight
