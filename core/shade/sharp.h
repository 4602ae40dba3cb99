#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/geometry/surface.h"

namespace relight {

/// Vertices whose light differs from a neighbour's (along an edge of a face) by more than a smooth
/// light's would: where a shadow's edge, or a whole shadow, falls between two vertices. Ascending.
/// With E the luminance of the irradiance, `irradiance` V long, an edge from a to b is sharp if
///     |E_a - E_b| > max(E_a, E_b) / 2 + 2 max(E) |n_a - n_b|,
/// one of the two being lit at all: by a thousandth of the brightest vertex. A distant light gives
/// E_perp cos, and |cos_a - cos_b| <= |n_a - n_b|: the second term is twice what turning the normal
/// explains, if some vertex faces the light (half as much will do). The first is what is left to a
/// light's distance on a mesh that resolves it: below a point light of height h no edge shorter
/// than 0.4 h falls to half. Longer ones are sharp without a shadow, and just as coarse.
std::vector<std::uint32_t> sharp_vertices(const Mesh& mesh, const Surface& surface,
                                          std::span<const Rgbf> irradiance, unsigned threads,
                                          Progress& progress);

}  // namespace relight
