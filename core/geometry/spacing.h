#pragma once

#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/vec.h"
#include "core/geometry/neighbours.h"

namespace relight {

/// Local spacing of a cloud: 1 / sqrt(points per area), from the disc that holds the 8 nearest
/// neighbours: s = d_8 sqrt(pi / 8) [scene units]. 0 where a point has 8 others in its very place,
/// or no neighbours. A stray point far from the others is no sign of a large surface: no point is
/// spaced more than three times as wide as the median of those 8.
std::vector<float> cloud_spacing(std::span<const Point3> points, const Neighbours& neighbours,
                                 unsigned threads, Progress& progress);

/// Share of the light that falls through a random cloud of this local spacing s covered by discs of
/// radius f s: exp(-pi f^2), the chance that none of the discs, one per s^2, covers a place
/// (Poisson). 0.09 % for f = 1.5. A cloud sampled more evenly leaks less.
double expected_leak(double radius_scale);

}  // namespace relight
