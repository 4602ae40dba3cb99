#pragma once

#include "core/base/sobol.h"
#include "core/light/light_sample.h"

namespace relight {

/// A ball that shines outward. Power is its radiance L.
struct SphereLight {
    Point3 center;
    double radius = 0.0;  ///< scene units
};

/// [scene units squared]. Flux is pi L A.
double area(const SphereLight& light);

/// E at p facing n from radiance 1 [sr]; 0 within the ball.   Test: SphereLight.*
double irradiance(const SphereLight& light, Point3 p, Dir3 n);

/// Uniform in the cone that the ball subtends; the distance is that of its near side.
LightSample sample(const SphereLight& light, Point3 p, Sample2 s);
LightSample look(const SphereLight& light, Point3 p, Dir3 wi);

}  // namespace relight
