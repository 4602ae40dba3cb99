#pragma once

#include <string_view>

namespace relight {

/// server/openapi.json, OpenAPI 3.1.
std::string_view openapi_json();

}  // namespace relight
