#pragma once

#include <algorithm>
#include <numbers>
#include <optional>

#include "core/base/quantity.h"
#include "core/base/vec.h"

namespace relight {

/// A point that shines alike in every direction. How strongly is not its own: see Light::power.
struct PointLight {
    Point3 position;              ///< scene space
    std::optional<double> range;  ///< distance at which glTF's window reaches 0 [scene units]
};

/// Nearer than this [scene units] a light counts as being at the receiver, where E has no limit: it
/// gives 0. 1/d^2 then stays below 1e30, which single precision holds with room for the power.
inline constexpr double coincident_distance = 1e-15;

/// I = Phi / 4 pi [W/sr]: the flux spreads over the whole sphere of directions.
/// Test: PointLight.SendsAllItsFluxThroughAnySphereAroundIt
inline RadiantIntensity intensity_of_flux(const PointLight& /*light*/, RadiantFlux Phi)
{
    return {Phi.value / (4.0 * std::numbers::pi)};
}

/// dw/dA = cos(theta) / d^2 [sr/m^2]: solid angle a unit patch subtends from distance d.
/// 0 at the light itself (d < coincident_distance) and beyond all numbers.
constexpr SolidAnglePerArea solid_angle_per_area(double cos_theta, double distance)
{
    if (!(distance >= coincident_distance)) { return {}; }
    return {cos_theta / distance / distance};
}

/// max(min(1 - (d/range)^4, 1), 0): fades a light out at its range.   KHR_lights_punctual
/// 1 without a range: pure inverse square.   Test: PointLight.GivesNothingAtItsRangeAndBeyond
constexpr double range_window(double distance, std::optional<double> range)
{
    if (!range) { return 1.0; }
    const double ratio2 = (distance / *range) * (distance / *range);
    return std::max(std::min(1.0 - ratio2 * ratio2, 1.0), 0.0);
}

/// E = I dw/dA [W/m^2] at p, facing n; nothing from behind.   Article: point source, cos/r^2.
/// Unoccluded: transport/ asks trace/ for the shadow.   Test: PointLight.*
inline Irradiance irradiance(const PointLight& light, RadiantIntensity I, Point3 p, Dir3 n)
{
    const Vec3 to_light = light.position - p;
    const double distance = length(to_light);
    const double cos_theta = dot(n, normalize(to_light));
    if (cos_theta <= 0.0) { return {}; }
    return I * solid_angle_per_area(cos_theta, distance) * range_window(distance, light.range);
}

}  // namespace relight
