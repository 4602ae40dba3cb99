#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/vec.h"

namespace relight {

/// Normals of a cloud from each point's nearest neighbours: the direction of least spread
/// (principal components; Hoppe et al. 1992), on one side of the surface throughout. `absent`
/// (ascending) are no points. "No direction" where the neighbours span no plane, and where absent.
/// The side: toward `toward` where that is given (a scanner sees only fronts); otherwise neighbours
/// agree with each other, along the minimum spanning tree that prefers parallel planes, and each
/// connected part of the cloud turns outward if it encloses something, else to the positive side of
/// the axis that it faces most (the sky, for terrain with z up).
/// The same points give the same bytes, whatever the threads.
std::vector<Dir3> estimate_normals(std::span<const Point3> points,
                                   std::span<const std::uint32_t> absent,
                                   const std::optional<Point3>& toward, unsigned threads,
                                   Progress& progress);

}  // namespace relight
