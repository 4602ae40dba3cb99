#pragma once

#include <span>

#include "core/base/vec.h"

namespace relight {

/// E [W/m^2] at p facing n from a flat convex polygon of radiance 1 that shines on the side of
/// (v1 - v0) x (v2 - v0): clipped to the horizon, then (1/2) |sum Gamma_i . n|   (Lambert 1760;
/// contract section 2). 0 from behind it and in its plane.   Test: Polygon.*
double polygon_irradiance(std::span<const Point3> corners, Point3 p, Dir3 n);

}  // namespace relight
