#pragma once

#include <array>

#include "core/base/sobol.h"
#include "core/light/light_sample.h"

namespace relight {

/// A triangle as a place sees it: what its samples and their density are made of.
struct TriangleView {
    double solid_angle = 0.0;  ///< that is drawn from [sr]; 0: nothing is to be seen
    bool by_area = false;      ///< too small for directions: drawn by its area
    Vec3 a, b, c;              ///< the corners from the place, or from just above it
    Vec3 normal;               ///< (b - a) x (c - a)
    double volume = 0.0;       ///< a . normal: six tetrahedra
};
TriangleView view(const std::array<Point3, 3>& triangle, Point3 p);
LightSample sample(const TriangleView& view, Sample2 s);
LightSample look(const TriangleView& view, Dir3 wi);

/// Solid angle of a triangle seen from p [sr]; 0 in its plane.   Van Oosterom & Strackee 1983
double solid_angle(const std::array<Point3, 3>& triangle, Point3 p);

/// A direction toward a triangle, uniform in the solid angle that it subtends at p (as Arvo 1995,
/// by another way); uniform over its area, with the density turned into [1/sr], where that angle
/// is too small for its digits. L is left 0: what shines is the caller's matter. "no direction"
/// for a triangle that subtends nothing.   Test: TriangleSampling.*
LightSample sample_triangle(const std::array<Point3, 3>& triangle, Point3 p, Sample2 s);
/// The same seen along wi; "no direction" where it misses.
LightSample look_at_triangle(const std::array<Point3, 3>& triangle, Point3 p, Dir3 wi);

}  // namespace relight
