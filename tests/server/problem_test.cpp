#include "server/problem.h"

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

namespace relight {
namespace {

std::vector<Fault> every_fault()
{
    std::vector<Fault> faults;
    for (int i = 0; i <= static_cast<int>(Fault::Internal); ++i) {
        faults.push_back(static_cast<Fault>(i));
    }
    return faults;
}

TEST(Problem, EveryFaultHasItsOwnCodeAndAnErrorStatus)
{
    std::set<std::string_view> codes;
    for (const Fault fault : every_fault()) {
        EXPECT_TRUE(codes.insert(fault_code(fault)).second) << fault_code(fault);
        EXPECT_GE(problem_kind(fault).status, 400);
        EXPECT_LT(problem_kind(fault).status, 600);
        EXPECT_FALSE(problem_kind(fault).title.empty());
    }
}

TEST(Problem, IsJsonWithTheMembersOfRfc9457)
{
    const auto json = nlohmann::json::parse(
        problem_json({Fault::OutOfRange, "found \"x\"\n", "/lights/1/flux_w", {}, {}}));
    EXPECT_EQ(json.at("type"), "/problems/out_of_range");
    EXPECT_EQ(json.at("status"), 422);
    EXPECT_EQ(json.at("code"), "out_of_range");
    EXPECT_EQ(json.at("detail"), "found \"x\"\n");
    EXPECT_EQ(json.at("pointer"), "/lights/1/flux_w");
    EXPECT_FALSE(json.at("title").get<std::string>().empty());
}

TEST(Problem, NamesALineOrByteOfAFileInPlaceOfAPointer)
{
    const auto line = nlohmann::json::parse(problem_json({Fault::MalformedBody, "x", "", 7, {}}));
    EXPECT_EQ(line.at("line"), 7);
    EXPECT_FALSE(line.contains("pointer"));
    const auto byte = nlohmann::json::parse(problem_json({Fault::Truncated, "x", "", {}, 70}));
    EXPECT_EQ(byte.at("byte"), 70);
}

TEST(Problem, EveryCodeStandsInTheApiDescription)
{
    std::ifstream file(std::string(RELIGHT_SOURCE_DIR) + "/server/openapi.json");
    const auto api = nlohmann::json::parse(file);
    const auto& listed =
        api.at("components").at("schemas").at("Problem").at("properties").at("code").at("enum");
    std::set<std::string> codes(listed.begin(), listed.end());
    EXPECT_EQ(codes.size(), listed.size());
    for (const Fault fault : every_fault()) { codes.erase(std::string(fault_code(fault))); }
    EXPECT_TRUE(codes.empty()) << "listed but unknown: " << *codes.begin();
    EXPECT_EQ(listed.size(), every_fault().size());
}

}  // namespace
}  // namespace relight
