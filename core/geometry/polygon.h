#pragma once

#include <span>
#include <vector>

#include "core/base/vec.h"

namespace relight {

/// Splits a polygon into triangles of its own corners, keeping its winding. `corners` are vertex
/// indices into `positions`, at least three. Convex polygons become fans; others are ear-clipped in
/// the plane of their Newell normal. Appends corners.size() - 2 triangles.
/// Beyond `most_corners_clipped` a concave polygon becomes a fan as well (ear clipping costs the
/// square of the corners); returns false then.
bool triangulate(std::span<const Point3> positions, std::span<const unsigned> corners,
                 std::vector<Triangle>& triangles);

inline constexpr std::size_t most_corners_clipped = 512;

}  // namespace relight
