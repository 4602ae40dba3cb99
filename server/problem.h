#pragma once

#include <string>
#include <string_view>

#include "core/base/result.h"

namespace relight {

/// What HTTP says of a fault: its status, and a title that is the same for every occurrence.
struct ProblemKind {
    int status{};
    std::string_view title;
};
ProblemKind problem_kind(Fault fault);

inline constexpr std::string_view problem_type = "application/problem+json";

/// RFC 9457: {"type","title","status","detail","code"} and the place, "pointer" or "line" or
/// "byte".
/// `status` where HTTP asks for another than the fault's own (501, 414 …); 0: the fault's.
std::string problem_json(const Error& error, int status = 0);

}  // namespace relight
