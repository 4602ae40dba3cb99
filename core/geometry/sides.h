#pragma once

#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/vec.h"
#include "core/geometry/neighbours.h"

namespace relight {

/// Turns the normals of a cloud, either of which may be on the wrong side, to one side of the
/// surface: neighbours agree with each other, along the minimum spanning tree that prefers parallel
/// planes and steps along them; and each connected part turns outward if it encloses something,
/// else to the positive side of the axis that it faces most. See estimate_normals.
void choose_sides(std::span<const Point3> points, const Neighbours& neighbours,
                  std::span<const float> spacing, unsigned threads, Progress& progress,
                  std::vector<Dir3>& normals);

}  // namespace relight
