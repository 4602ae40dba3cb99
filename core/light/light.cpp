#include "core/light/light.h"

#include <limits>

namespace relight {
namespace {

/// A light at a place; `falloff(wi, distance)` is what it keeps of the inverse square.
template <class Falloff>
Arrival arrive_from(Point3 position, Point3 p, Falloff falloff)
{
    const Vec3 to_light = position - p;
    const double distance = length(to_light);
    const Dir3 wi = normalize(to_light);
    const double per_area = solid_angle_per_area(1.0, distance).value;
    if (!wi || per_area == 0.0) { return {}; }  // at the receiver, or too far to matter
    return {to_light, distance, wi, per_area * falloff(wi, distance)};
}

struct Arrive {
    Point3 p;

    Arrival operator()(const PointLight& light) const
    {
        return arrive_from(light.position, p, [&](Dir3 /*wi*/, double distance) {
            return range_window(distance, light.range);
        });
    }
    Arrival operator()(const SpotLight& light) const
    {
        return arrive_from(light.position, p, [&](Dir3 wi, double /*distance*/) {
            return cone_falloff(light, dot(-wi, light.axis));
        });
    }
    Arrival operator()(const DirectionalLight& light) const
    {
        const Dir3 wi = -light.travel;
        return {wi, std::numeric_limits<double>::infinity(), wi, wi ? 1.0 : 0.0};
    }
};

}  // namespace

Arrival arrive(const LightShape& shape, Point3 p)
{
    return std::visit(Arrive{p}, shape);
}

}  // namespace relight
