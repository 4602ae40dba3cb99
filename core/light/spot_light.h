#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/base/quantity.h"
#include "core/base/vec.h"
#include "core/light/point_light.h"

namespace relight {

/// A point that shines into a cone: fully within the inner angle, not at all outside the outer one.
struct SpotLight {
    Point3 position;                              ///< scene space
    Dir3 axis;                                    ///< the way its light travels
    double inner_cone = 0.0;                      ///< half angle [rad], 0 <= inner < outer
    double outer_cone = 0.25 * std::numbers::pi;  ///< half angle [rad], at most pi / 2
    std::optional<double> range{};                ///< as PointLight's
};

/// Least difference of the cones' cosines (KHR_lights_punctual): no division by zero where they
/// meet.
inline constexpr double least_cone_ramp = 0.001;

/// t^2, t = clamp((cd - cos outer) / max(0.001, cos inner - cos outer), 0, 1), cd = cosine between
/// the axis and the direction from the light.   KHR_lights_punctual   Test: SpotLight.*
inline double cone_falloff(const SpotLight& light, double cd)
{
    const double cos_outer = std::cos(light.outer_cone);
    const double ramp = std::max(least_cone_ramp, std::cos(light.inner_cone) - cos_outer);
    const double t = std::clamp((cd - cos_outer) / ramp, 0.0, 1.0);
    return t * t;
}

/// Omega = integral of t^2 over the sphere [sr], so that Phi = I Omega.
/// With x = cd, t climbs from 0 at cos(outer) over w = max(0.001, cos inner - cos outer), if there
/// is that much left before x = 1:  Omega = 2 pi [ (h - b) + b^3 / (3 w^2) ],  h = 1 - cos(outer),
/// b = min(w, h). Where the ramp is wider than 0.001 this is 2 pi [(1 - cos in) + (cos in - cos
/// out)/3]. 1 - cos = 2 sin^2(half) keeps narrow cones exact.   Test:
/// SpotLight.FluxIsIntensityTimesSolidAngle
inline double emission_solid_angle(const SpotLight& light)
{
    const auto one_minus_cos = [](double angle) {
        const double sine = std::sin(0.5 * angle);
        return 2.0 * sine * sine;
    };
    const double h = one_minus_cos(light.outer_cone);
    const double w = std::max(least_cone_ramp, h - one_minus_cos(light.inner_cone));
    const double b = std::min(w, h);
    return 2.0 * std::numbers::pi * ((h - b) + b * b * b / (3.0 * w * w));
}

/// I = Phi / Omega [W/sr], the intensity inside the inner cone; 0 for a cone that is as good as
/// closed (half angle below about 1e-6 rad), where no number would do.
inline RadiantIntensity intensity_of_flux(const SpotLight& light, RadiantFlux Phi)
{
    constexpr double closed = 1e-30;  // [sr]
    const double Omega = emission_solid_angle(light);
    return {Omega > closed ? Phi.value / Omega : Rgb{}};
}

/// E = I t^2 dw/dA [W/m^2] at p, facing n: a point light seen through its cone. Unoccluded.
inline Irradiance irradiance(const SpotLight& light, RadiantIntensity I, Point3 p, Dir3 n)
{
    const Vec3 to_light = light.position - p;
    const Dir3 wi = normalize(to_light);
    const double cos_theta = dot(n, wi);
    if (cos_theta <= 0.0) { return {}; }
    return I * solid_angle_per_area(cos_theta, length(to_light)) *
           (cone_falloff(light, dot(-wi, light.axis)) *
            range_window(length(to_light), light.range));
}

}  // namespace relight
