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

struct See {
    Point3 p;

    LightView operator()(const RectLight& light) const { return RectView(light, p); }
    LightView operator()(const DiskLight& light) const { return DiskView(light, p); }
    LightView operator()(const SphereLight& light) const { return SphereView(light, p); }
    LightView operator()(const DirectionalLight& light) const { return SunView(light); }
    LightView operator()(const EnvironmentLight& light) const { return EnvironmentView(light); }
    LightView operator()(const SkyLight& light) const { return SkyView(light); }
    LightView operator()(const MeshLight& light) const { return MeshView{light.table.get(), p}; }
    template <class Delta>
    LightView operator()(const Delta& /*light*/) const
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

LightView view(const LightShape& shape, Point3 p)
{
    return std::visit(See{p}, shape);
}

LightSample sample(const LightView& view, Sample2 s, double pick)
{
    return std::visit(
        [&](const auto& seen) -> LightSample {
            using View = std::decay_t<decltype(seen)>;
            if constexpr (std::is_same_v<View, std::monostate>) {
                return {};
            } else if constexpr (std::is_same_v<View, SkyView> || std::is_same_v<View, MeshView>) {
                return seen.sample(s, pick);
            } else {
                return seen.sample(s);
            }
        },
        view);
}

LightSample look(const LightView& view, Dir3 wi)
{
    return std::visit(
        [&](const auto& seen) -> LightSample {
            using View = std::decay_t<decltype(seen)>;
            if constexpr (std::is_same_v<View, std::monostate> || std::is_same_v<View, MeshView>) {
                return {};
            } else {
                return seen.look(wi);
            }
        },
        view);
}

LightSample sample(const LightShape& shape, Point3 p, Sample2 s, double pick)
{
    return sample(view(shape, p), s, pick);
}

LightSample look(const LightShape& shape, Point3 p, Dir3 wi)
{
    return look(view(shape, p), wi);
}

std::optional<double> closed_irradiance(const LightShape& shape, Point3 p, Dir3 n)
{
    return std::visit(ClosedIrradiance{p, n}, shape);
}

void closed_irradiance(const LightShape& shape, std::span<const Point3> p, std::span<const Dir3> n,
                       std::span<double> E)
{
    if (const auto* rect = std::get_if<RectLight>(&shape)) { return irradiance(*rect, p, n, E); }
    for (std::size_t i = 0; i < p.size(); ++i) {
        E[i] = closed_irradiance(shape, p[i], n[i]).value_or(0.0);
    }
}

bool is_grey(const LightShape& shape)
{
    const auto* sky = std::get_if<EnvironmentLight>(&shape);
    return !(sky != nullptr && sky->map) && !std::holds_alternative<SkyLight>(shape) &&
           !std::holds_alternative<MeshLight>(shape);
}

}  // namespace relight
