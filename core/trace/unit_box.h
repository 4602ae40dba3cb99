#pragma once

#include <algorithm>
#include <cmath>

#include "core/base/vec.h"

namespace relight {

/// A shadow ray in scene units: from p (already off the surface) toward wi, as far as `distance`.
struct ShadowRay {
    Point3 origin;
    Dir3 direction;
    double from{};      ///< nothing nearer than this counts, scene units
    double distance{};  ///< nothing beyond it does, scene units; infinite is allowed
};

/// A ray in floats and in the unit box.
struct BoxRay {
    float org_x, org_y, org_z, tnear;
    float dir_x, dir_y, dir_z, tfar;
};

/// The model recentred and scaled in double, before anything becomes float.
struct UnitBox {
    Point3 centre;
    double scale = 1.0;  ///< scene units -> unit box; a power of two, so it rounds nothing

    /// Floats start this much before the ray, lest rounding put them beyond what it should meet:
    /// what is met at more than 5 degrees to its plane is met. No more, because a receiver should
    /// not cross the surface it stands on (that costs a look in double): a mesh of 20 M triangles
    /// steps off by 3e-6.
    static constexpr double step_back = 2e-6;
    /// Nothing of the model lies further than its diagonal (2 in the box) from its bounds: a ray
    /// ends this much beyond its origin's coordinates at the latest.
    static constexpr double beyond = 4.0;

    Vec3 to_box(Point3 p) const { return (p - centre) * scale; }

    BoxRay ray(const ShadowRay& asked) const
    {
        const Vec3 direction = asked.direction;
        const Vec3 origin = to_box(asked.origin) - direction * step_back;
        const double reach = beyond + std::abs(origin.x) + std::abs(origin.y) + std::abs(origin.z);
        const auto f = [](double x) { return static_cast<float>(x); };
        return {f(origin.x),    f(origin.y),
                f(origin.z),    f(asked.from * scale),
                f(direction.x), f(direction.y),
                f(direction.z), f(std::min(asked.distance * scale, reach) + 2.0 * step_back)};
    }
};

/// A receiver steps `offset` along its normal before it looks around, and ignores what is nearer
/// than `from` along the ray. Both in scene units.
struct Clearance {
    double offset{};
    double from{};
};

/// Clearance by the spacing around a receiver, in scene units.
struct ClearanceRule {
    double least{}, most{}, offset_per_spacing{}, from_per_spacing{};

    Clearance operator()(double spacing) const
    {
        return {std::max(least, std::min(most, offset_per_spacing * spacing)),
                from_per_spacing * spacing};
    }
};

}  // namespace relight
