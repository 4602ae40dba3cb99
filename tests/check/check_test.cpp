#include "core/check/check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

namespace relight {
namespace {

const std::vector<CheckCase>& all_cases()
{
    static const std::vector<CheckCase> cases = [] {
        Progress progress;
        return run_checks(0, progress);
    }();
    return cases;
}

TEST(Check, EveryCasePasses)
{
    EXPECT_GT(all_cases().size(), 100U);
    for (const CheckCase& c : all_cases()) {
        EXPECT_TRUE(c.pass()) << c.group << ": " << c.name << ": expected " << c.expected
                              << ", computed " << c.computed << ", off by " << c.error()
                              << ", allowed " << c.tolerance;
    }
}

TEST(Check, EveryGroupThatIsPromisedIsThere)
{
    std::set<std::string> groups;
    for (const CheckCase& c : all_cases()) { groups.insert(c.group); }
    for (const char* group :
         {"point", "spot", "sun", "polygon", "sphere", "disk", "sky", "half-plane blocker",
          "furnace", "D", "G1", "Jacobian", "reciprocity", "integrating sphere"}) {
        EXPECT_TRUE(groups.contains(group)) << group;
    }
}

TEST(Check, EveryCaseIsNamedOnceAndSaysWhatItIs)
{
    std::set<std::string> names;
    for (const CheckCase& c : all_cases()) {
        EXPECT_TRUE(names.insert(c.name).second) << c.name;
        EXPECT_FALSE(c.name.empty() || c.formula.empty() || c.unit.empty()) << c.name;
        EXPECT_FALSE(c.group.empty() || c.tolerance_kind.empty()) << c.name;
        for (const double x : {c.expected, c.computed, c.tolerance}) {
            EXPECT_TRUE(std::isfinite(x)) << c.name;
        }
    }
}

TEST(Check, NoToleranceIsSoWideThatADarkLightWouldPass)
{
    for (const CheckCase& c : all_cases()) {
        CheckCase dark = c;
        dark.computed = 0.0;
        EXPECT_TRUE(c.expected == 0.0 || !dark.pass()) << c.name;
        EXPECT_LE(c.tolerance, c.expected == 0.0 ? 1e-4 : 0.06 * std::abs(c.expected)) << c.name;
    }
}

TEST(Check, AWrongExpectationFails)
{
    for (CheckCase c : all_cases()) {
        c.expected += 2.001 * c.tolerance + 1e-9;
        EXPECT_FALSE(c.pass()) << c.name;
    }
}

TEST(Check, WhatIsNotANumberNeverPasses)
{
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double inf = std::numeric_limits<double>::infinity();
    const CheckCase good{"name", "group", "1 = 1", "1", 1.0, 1.0, 1e-6, "relative 1e-06"};
    EXPECT_TRUE(good.pass());
    for (const double bad : {nan, inf, -inf}) {
        CheckCase c = good;
        c.computed = bad;
        EXPECT_FALSE(c.pass());
        c = good;
        c.expected = bad;
        EXPECT_FALSE(c.pass());
        c = good;
        c.tolerance = bad;
        EXPECT_FALSE(c.pass());
        c.expected = c.computed = bad;
        EXPECT_FALSE(c.pass());
    }
}

TEST(Check, TheSameNumbersOnAnyNumberOfThreads)
{
    Progress progress;
    const auto one = run_checks(1, progress);
    ASSERT_EQ(one.size(), all_cases().size());
    for (std::size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(one[i].computed, all_cases()[i].computed) << one[i].name;
        EXPECT_EQ(one[i].name, all_cases()[i].name);
    }
}

TEST(Check, StoppedBeforeItBeginsItHasNothingToSay)
{
    Progress progress;
    progress.stop();
    EXPECT_TRUE(run_checks(2, progress).empty());
}

}  // namespace
}  // namespace relight
