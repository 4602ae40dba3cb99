#pragma once

#include "core/base/sobol.h"
#include "core/light/light_sample.h"

namespace relight {

/// A flat disk. Power is its radiance L; it shines on the side of `normal`.
struct DiskLight {
    Point3 center;
    Dir3 normal;
    double radius = 0.0;  ///< scene units
};

/// Of the side that shines [scene units squared]. Flux is pi L A.
double area(const DiskLight& light);

/// E at p facing n from radiance 1 [sr], in closed form also where the horizon cuts the disk; 0
/// from behind it and in its plane.   Test: DiskLight.*
double irradiance(const DiskLight& light, Point3 p, Dir3 n);

/// Toward the whole disk, with a density that is uniform in solid angle within a factor of two
/// everywhere (and exactly where the disk looks small): no receiver is too near.
LightSample sample(const DiskLight& light, Point3 p, Sample2 s);
LightSample look(const DiskLight& light, Point3 p, Dir3 wi);

}  // namespace relight
