#pragma once

#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/vec.h"

namespace relight {

/// Local spacing of a cloud: 1 / sqrt(points per area), from the disc that holds the 8 nearest
/// neighbours: s = d_8 sqrt(pi / 8) [scene units]. A random cloud covered by discs of radius f s
/// leaks exp(-pi f^2) of the light. 0 where a point has 8 others in its very place.
std::vector<float> cloud_spacing(std::span<const Point3> points, unsigned threads,
                                 Progress& progress);

}  // namespace relight
