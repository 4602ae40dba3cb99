#pragma once

#include <string_view>

#include "core/asset.h"
#include "core/base/result.h"
#include "server/request.h"

namespace relight {

/// The JSON of POST /v1/relight, read strictly: every Error carries the fault, the pointer to the
/// field and what is allowed there. `default_part`: the multipart body has a part "mesh", which is
/// the mesh when the request names none. `explain`: it must say which "vertices".
Result<RelightRequest> parse_request(std::string_view json, const ParseLimits& limits,
                                     bool default_part = false, bool explain = false);

/// What depends on the mesh: the camera that frames it, which group has which material, the
/// triangles that shine, the lights that the file brings (for "from_mesh", and for a request that
/// names none; without any, a sun), its own materials where the request has none. And what takes
/// its time: tables of skies and materials. Errors: ZeroDirection if the camera stands on its
/// target, UnknownValue and ConflictingFields at a material that the mesh cannot have, MissingField
/// at a "from_mesh" of a file without lights, MixedUnits where its lights (cd, lx) stand beside
/// watts. `mesh` is the asset's, or what refining made of it; `surface` is that of `mesh`.
Result<Scene> complete(const RelightRequest& request, const Asset& asset, const Mesh& mesh,
                       const Surface& surface);

}  // namespace relight
