#pragma once

#include <gtest/gtest.h>

#include <set>
#include <span>
#include <string>

#include "server/problem.h"
#include "server/scene_json.h"

namespace relight::test {

/// A request that is wrong in one way, and what the answer must say.
struct Refusal {
    std::string json;
    int status;
    Fault fault;
    std::string pointer;
    std::string says;  ///< of the detail: what is allowed, or what to do
};

/// A request of one triangle, with these fields beside it.
inline std::string with(const std::string& fields)
{
    return R"({"mesh":{"positions":[[0,0,0],[1,0,0],[0,1,0]],"faces":[[0,1,2]]},)" + fields + "}";
}
inline std::string with_light(const std::string& fields)
{
    return with(R"("lights":[{)" + fields + "}]");
}
inline std::string with_material(const std::string& fields)
{
    return with(R"("material":{)" + fields + "}");
}

/// Every row is refused as it says, and no two rows are the same request.
inline void expect_refusals(std::span<const Refusal> rows)
{
    std::set<std::string> seen;
    for (const Refusal& row : rows) {
        EXPECT_TRUE(seen.insert(row.json).second) << "twice: " << row.json;
        const auto request = parse_request(row.json, {});
        ASSERT_FALSE(request) << row.json;
        const Error& error = request.error();
        EXPECT_EQ(fault_code(error.fault), fault_code(row.fault)) << row.json << '\n'
                                                                  << error.detail;
        EXPECT_EQ(problem_kind(error.fault).status, row.status) << row.json;
        EXPECT_EQ(error.pointer, row.pointer) << row.json << '\n' << error.detail;
        ASSERT_FALSE(row.says.empty()) << row.json;
        EXPECT_NE(error.detail.find(row.says), std::string::npos)
            << row.json << '\n'
            << error.detail << "\ndoes not say: " << row.says;
    }
}

}  // namespace relight::test
