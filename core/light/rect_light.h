#pragma once

#include "core/base/sobol.h"
#include "core/light/light_sample.h"

namespace relight {

/// A flat rectangle (or parallelogram). Power is its radiance L; it shines toward u x v.
struct RectLight {
    Point3 center;
    Vec3 edge_u, edge_v;  ///< whole edges, scene units: corners are center +- u/2 +- v/2
    bool two_sided = false;
};

/// Of one side [scene units squared]. Flux is pi L A, twice that of a two-sided one.
double area(const RectLight& light);

/// E at p facing n from radiance 1 [sr].   Test: Polygon.ARectangle*
double irradiance(const RectLight& light, Point3 p, Dir3 n);

/// Uniform in the solid angle of the whole rectangle, that is of its two triangles. "no direction"
/// from behind, in its plane, or without area.
LightSample sample(const RectLight& light, Point3 p, Sample2 s);
LightSample look(const RectLight& light, Point3 p, Dir3 wi);

}  // namespace relight
