#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/vec.h"
#include "core/geometry/neighbours.h"

namespace relight {

/// Normals of a cloud from each point's nearest neighbours: the direction of least spread
/// (principal components; Hoppe et al. 1992), on one side of the surface throughout. "No direction"
/// where the neighbours span no plane (fewer than two, all on a line, all in one place).
/// The side: toward `toward` where that is given (a scanner sees only fronts); otherwise neighbours
/// agree with each other, along the minimum spanning tree that prefers parallel planes and steps
/// along them, and each connected part of the cloud turns outward if it encloses something, else to
/// the positive side of the axis that it faces most (the sky, for terrain with z up).
/// @param spacing of each point (cloud_spacing): it stands for so much squared of the surface
/// The same points give the same bytes, whatever the threads.
std::vector<Dir3> estimate_normals(std::span<const Point3> points, const Neighbours& neighbours,
                                   std::span<const float> spacing,
                                   const std::optional<Point3>& toward, unsigned threads,
                                   Progress& progress);

/// Surface::bend. Over a sphere of radius r, a tangent disc of radius R = 1.5 spacings rises until
/// it is tan(d / 2) = R / r beyond the horizon: some 3 spacings, or 4 of an even cloud's steps. The
/// neighbours reach half as far.
std::vector<float> cloud_bend(std::span<const Dir3> normals, const Neighbours& neighbours,
                              unsigned threads, Progress& progress);

}  // namespace relight
