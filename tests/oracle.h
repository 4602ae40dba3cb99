#pragma once

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/base/rgb.h"
#include "core/base/vec.h"

namespace relight::test {

/// A file of expected values, computed independently of this code (tests/data/oracle/README.md).
inline nlohmann::json oracle(const std::string& name)
{
    std::ifstream file(std::string(RELIGHT_TEST_DATA) + "/oracle/" + name + ".json");
    return nlohmann::json::parse(file);
}

inline Point3 point_of(const nlohmann::json& j)
{
    return {j[0], j[1], j[2]};
}
inline Vec3 vec_of(const nlohmann::json& j)
{
    return {j[0], j[1], j[2]};
}
inline Rgb rgb_of(const nlohmann::json& j)
{
    return {j[0], j[1], j[2]};
}

/// Passes when |x - e| <= max(rel |e|, abs).
struct Tolerance {
    double rel = 0.0, abs = 0.0;
    explicit Tolerance(const nlohmann::json& j) : rel(j.value("rel", 0.0)), abs(j.value("abs", 0.0))
    {
    }
    Tolerance(double relative, double absolute) : rel(relative), abs(absolute) {}
    bool holds(double x, double e) const
    {
        return std::abs(x - e) <= std::max(rel * std::abs(e), abs);
    }
};

}  // namespace relight::test
