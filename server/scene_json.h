#pragma once

#include <string_view>

#include "core/base/result.h"
#include "server/request.h"

namespace relight {

/// The JSON of POST /v1/relight, read strictly: every Error carries the fault, the pointer to the
/// field and what is allowed there. `default_part`: the multipart body has a part "mesh", which is
/// the mesh when the request names none.
Result<RelightRequest> parse_request(std::string_view json, const ParseLimits& limits,
                                     bool default_part = false);

/// What depends on the mesh: the camera that frames it, the default sun. Error ZeroDirection if the
/// camera stands on its target.
Result<Scene> complete(const RelightRequest& request, const Bounds& bounds);

}  // namespace relight
