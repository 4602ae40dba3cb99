#pragma once

#include <string>
#include <variant>

#include "core/light/directional_light.h"
#include "core/light/point_light.h"
#include "core/light/spot_light.h"

namespace relight {

/// What the light is. A new kind is a file here and a line in this variant.
using LightShape = std::variant<PointLight, SpotLight, DirectionalLight>;

/// A light of the request. The shape carries unit power; `power` says how much of it and in which
/// colour, so that a transport column (the shape's) outlives a change of power (a dot product).
struct Light {
    std::string name;
    LightShape shape;
    /// I [W/sr] or [cd] of point and spot; E_perp [W/m^2] or [lx] of directional.
    Rgb power = Rgb::grey(1.0);
    bool enabled = true;
    bool cast_shadows = true;
};

/// What one unit of a light brings to a receiver, unoccluded.
struct Arrival {
    Vec3 to_light;      ///< not unit; from the receiver to the light (or along it, if directional)
    double distance{};  ///< to the light, scene units; infinite for directional
    Dir3 wi;            ///< unit; "no direction" where the light is at the receiver
    double per_unit{};  ///< E facing wi from unit power, cone included: 1/d^2 [sr/m^2], or 1
};

/// Unoccluded arrival of one unit of the light at p. E = power * per_unit * (n . wi)+.
Arrival arrive(const LightShape& shape, Point3 p);

}  // namespace relight
