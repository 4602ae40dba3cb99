#pragma once

#include <optional>
#include <string_view>
#include <variant>

#include "server/fields.h"
#include "server/request.h"

namespace relight {

/// {"id": …} or {"part": …}, finished; nothing if `fields` has neither. `route` stores such files:
/// "POST /v1/meshes".
std::optional<std::variant<StoredMesh, PartMesh>> parse_file_source(Fields& fields,
                                                                    std::string_view route);

}  // namespace relight
