#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/geometry/surface.h"

namespace relight {

std::vector<std::uint32_t> sharp_vertices(const Mesh& mesh, const Surface& surface,
                                          std::span<const Rgbf> irradiance);

}  // namespace relight
