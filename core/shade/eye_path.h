#pragma once

#include <cstdint>

#include "core/base/sobol.h"
#include "core/shade/seen.h"
#include "core/shade/world.h"
#include "core/transport/gather.h"

namespace relight {

/// A path that comes from the eye, at a place where it looks for light.
struct EyePath {
    Seen seen;
    Rgb weight = Rgb::grey(1.0);  ///< share of the light found here that reaches the eye
    Rgb* sums = nullptr;          ///< where it is added: one of scene.lights each
    Sequence sequence;
    std::uint32_t point = 0;  ///< of the sequence
};

/// Pairs of dimensions of a path's sequence: at each place two for the way on and two a light.
struct Dimensions {
    std::uint32_t way, way_pick, first_light;

    /// @param depth places before this one
    Dimensions(std::uint32_t depth, std::size_t lights)
        : way(depth * (2 + 2 * static_cast<std::uint32_t>(lights))),
          way_pick(way + 1),
          first_light(way + 2)
    {
    }
    std::uint32_t light(const Lamp& lamp) const
    {
        return first_light + 2 * static_cast<std::uint32_t>(lamp.number);
    }
    std::uint32_t light_pick(const Lamp& lamp) const { return light(lamp) + 1; }
};

/// f cos, toward the eye.
inline Rgb response(const Seen& seen, Vec3 wi)
{
    return f(*seen.material, wi, seen.wo, seen.color).value * wi.z;
}

inline ShadowRay ray_toward(const World& world, const Seen& seen, Dir3 wi, double distance)
{
    return shadow_ray(*world.stage.bvh, seen.at, wi, distance, world.scene.transport);
}

/// Of light of unit power.
inline Deposit deposit(const EyePath& path, const Lamp& lamp, Rgb value)
{
    return {path.sums + lamp.number, value * lamp.light->power};
}

}  // namespace relight
