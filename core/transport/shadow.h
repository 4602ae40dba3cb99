#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/light/light.h"
#include "core/scene.h"
#include "core/trace/bvh.h"

namespace relight {

inline bool is_directional(const Arrival& arrival)
{
    return std::isinf(arrival.distance);
}

/// E of one unit of power on a surface that faces the light [1/m^2 sr, or 1]: distances are in
/// scene units, areas in square metres.
inline double per_unit_m2(const Arrival& arrival, double length_unit_m)
{
    return is_directional(arrival) ? arrival.per_unit
                                   : arrival.per_unit / (length_unit_m * length_unit_m);
}

/// The shadow ray of a receiver at p that looks from `origin` (p stepped off the surface): toward
/// the light's own place, and short of it by the light's own clearance.
inline ShadowRay shadow_ray(const Bvh& bvh, Point3 p, Point3 origin, double from,
                            const Arrival& arrival, const TransportOptions& options)
{
    const double reach = options.max_distance.value_or(std::numeric_limits<double>::infinity());
    if (is_directional(arrival)) { return {origin, arrival.wi, from, reach}; }
    const Vec3 to_light = p + arrival.to_light - origin;
    const Dir3 wi = normalize(to_light);
    const double distance = length(to_light) - bvh.clearance(0.0).offset;
    // A light closer than the step itself is not behind anything.
    if (!wi) { return {origin, arrival.wi, from, 0.0}; }
    return {origin, wi, from, std::max(0.0, std::min(reach, distance))};
}

}  // namespace relight
