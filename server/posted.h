#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/multipart.h"
#include "server/routes.h"

namespace relight {

/// A request as it came: its JSON, and the files beside it.
struct Posted {
    std::string json;
    std::vector<Part> parts;
    bool has_mesh_part = false;
};

/// Reads the body of a relight request: application/json, or multipart/form-data with its JSON in
/// the part "request". Its bytes count in `share`. Errors: BadRequest, UnsupportedMediaType,
/// and those of read_body(). Nothing: the connection failed, the guard answers.
Result<std::optional<Posted>> receive(const httplib::Request& request,
                                      const httplib::ContentReader& reader, ServerState& state,
                                      ByteBudget::Share& share);

}  // namespace relight
