#pragma once

#include <span>

#include "core/base/vec.h"

namespace relight {

// Readers decide Mesh::double_positions by these.

/// True if float would lose what text or a transform says: some coordinate moves by more than 1e-7
/// of the bounds' diagonal. Rounding that a file in floats has anyway does not count.
bool float_loses_text(std::span<const Point3> positions);

/// True if some coordinate is not exactly a float: of files that declare doubles.
bool float_loses(std::span<const Point3> positions);

}  // namespace relight
