#include "core/light/light.h"

#include <cmath>
#include <limits>
#include <numbers>

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
        return arrive_from(light.position, p, [&](Dir3 wi, double distance) {
            return cone_falloff(light, dot(-wi, light.axis)) * range_window(distance, light.range);
        });
    }
    Arrival operator()(const DirectionalLight& light) const
    {
        const Dir3 wi = -light.travel;
        return {wi, std::numeric_limits<double>::infinity(), wi, wi ? 1.0 : 0.0};
    }
    Arrival operator()(const IesLight& light) const
    {
        return arrive_from(light.position, p, [&](Dir3 wi, double /*distance*/) {
            return intensity_toward(light, wi);
        });
    }
    template <class Other>
    Arrival operator()(const Other& /*light*/) const
    {
        return {};
    }
};

struct SampleLight {
    Point3 p;
    Sample2 s;
    double pick;

    LightSample operator()(const RectLight& light) const { return sample(light, p, s); }
    LightSample operator()(const DiskLight& light) const { return sample(light, p, s); }
    LightSample operator()(const SphereLight& light) const { return sample(light, p, s); }
    LightSample operator()(const DirectionalLight& light) const { return sample(light, s); }
    LightSample operator()(const EnvironmentLight& light) const { return sample(light, s); }
    LightSample operator()(const SkyLight& light) const { return sample(light, s, pick); }
    LightSample operator()(const MeshLight& light) const { return light.table->sample(p, s, pick); }
    template <class Delta>
    LightSample operator()(const Delta& /*light*/) const
    {
        return {};
    }
};

struct LookAtLight {
    Point3 p;
    Dir3 wi;

    LightSample operator()(const RectLight& light) const { return look(light, p, wi); }
    LightSample operator()(const DiskLight& light) const { return look(light, p, wi); }
    LightSample operator()(const SphereLight& light) const { return look(light, p, wi); }
    LightSample operator()(const DirectionalLight& light) const { return look(light, wi); }
    LightSample operator()(const EnvironmentLight& light) const { return look(light, wi); }
    LightSample operator()(const SkyLight& light) const { return look(light, wi); }
    template <class Other>
    LightSample operator()(const Other& /*light*/) const
    {
        return {};
    }
};

struct ClosedIrradiance {
    Point3 p;
    Dir3 n;

    std::optional<double> operator()(const RectLight& l) const { return irradiance(l, p, n); }
    std::optional<double> operator()(const DiskLight& l) const { return irradiance(l, p, n); }
    std::optional<double> operator()(const SphereLight& l) const { return irradiance(l, p, n); }
    std::optional<double> operator()(const DirectionalLight& l) const { return irradiance(l, n); }
    std::optional<double> operator()(const EnvironmentLight& l) const
    {
        if (l.map) { return {}; }
        return std::numbers::pi;  // of radiance 1 from the whole hemisphere
    }
    template <class Other>
    std::optional<double> operator()(const Other& /*light*/) const
    {
        return {};
    }
};

}  // namespace

bool is_delta(const LightShape& shape)
{
    if (const auto* sun = std::get_if<DirectionalLight>(&shape)) { return sun->half_angle == 0.0; }
    return std::holds_alternative<PointLight>(shape) || std::holds_alternative<SpotLight>(shape) ||
           std::holds_alternative<IesLight>(shape);
}

Arrival arrive(const LightShape& shape, Point3 p)
{
    return std::visit(Arrive{p}, shape);
}

LightSample sample(const LightShape& shape, Point3 p, Sample2 s, double pick)
{
    return std::visit(SampleLight{p, s, pick}, shape);
}

LightSample look(const LightShape& shape, Point3 p, Dir3 wi)
{
    return std::visit(LookAtLight{p, wi}, shape);
}

std::optional<double> closed_irradiance(const LightShape& shape, Point3 p, Dir3 n)
{
    return std::visit(ClosedIrradiance{p, n}, shape);
}

bool is_grey(const LightShape& shape)
{
    const auto* sky = std::get_if<EnvironmentLight>(&shape);
    return !(sky != nullptr && sky->map) && !std::holds_alternative<SkyLight>(shape) &&
           !std::holds_alternative<MeshLight>(shape);
}

}  // namespace relight
