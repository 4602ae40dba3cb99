#pragma once

#include <map>
#include <string>

#include "core/scene.h"
#include "core/transport/transport.h"

namespace relight {

/// Of which file a light's map or profile was made: by its address.
using FileNames = std::map<const void*, std::string>;

/// What a column depends on beside the model, as a text: equal texts, equal columns. Nothing more
/// is in it, so that a column outlives every change that does not concern it. `light`: of Told::E
/// and Told::Lo; `sh`: of Told::Sky.
std::string column_key(Told told, const Scene& scene, std::size_t light, bool sh,
                       const FileNames& names);

}  // namespace relight
