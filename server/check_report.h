#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "core/check/check.h"

namespace relight {

std::size_t failures(std::span<const CheckCase> cases);

/// The answer of GET /v1/check: version, kernel, passed, failed, cases. What is not a number is
/// null; it does not pass.
std::string check_json(std::span<const CheckCase> cases, std::string_view version);

/// For people: a heading a group, a line a case, columns under each other, a summary at the end.
/// @param coloured marks passes green and failures red, for a terminal
std::string check_table(std::span<const CheckCase> cases, std::string_view version, bool coloured);

}  // namespace relight
