#pragma once

#include <string>
#include <vector>

#include "core/base/parallel.h"

namespace relight {

/// One thing that is known without the program, and what the program makes of it.
struct CheckCase {
    std::string name;     ///< unlike any other's
    std::string group;    ///< "point", "D", "half-plane blocker" ...
    std::string formula;  ///< of the expected value: "E = pi L R^2 / (R^2 + h^2)"
    std::string unit;     ///< of the values; "1" for a bare number
    double expected{}, computed{};
    double tolerance{};          ///< most that they may differ
    std::string tolerance_kind;  ///< how that was reckoned: "relative 1e-06"

    double error() const { return computed - expected; }
    /// False for anything that is not a number.
    bool pass() const;
};

/// Every closed form we know against the code that answers requests: lights by the whole walk from
/// a mesh to E, materials by their f. The expected values are written down from the literature, or
/// integrated here, and take nothing from the code that they check. The same numbers for any number
/// of threads; about a second on one. Stopped, it leaves out what it had not begun.
/// Test: Check.*
std::vector<CheckCase> run_checks(unsigned threads, Progress& progress);

}  // namespace relight
