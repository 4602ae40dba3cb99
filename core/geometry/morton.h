#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/geometry/surface.h"

namespace relight {

/// The indices of all points, sorted along Morton's curve (Morton 1966), so that points near in
/// space stand near in the order; ties by index. Cells are cubes, 1,024 along the longest side of
/// `box`, which holds the points; a cell that holds a crowd (of a cloud with a stray far away) is
/// divided anew. Coordinates that are no numbers count as the least. The same for any number of
/// threads; of no use once `progress` is stopped.
std::vector<std::uint32_t> morton_order(std::span<const Point3> points, const Bounds& box,
                                        unsigned threads, Progress& progress);

}  // namespace relight
