#include "core/shade/world.h"

#include <limits>
#include <tuple>
#include <utility>

#include "core/transport/gather.h"

namespace relight {
namespace {

/// A ball around a light that has a place and a size; of others all of space.
std::pair<Point3, double> ball_around(const LightShape& shape)
{
    if (const auto* rect = std::get_if<RectLight>(&shape)) {
        return {rect->center, 0.5 * std::max(length(rect->edge_u + rect->edge_v),
                                             length(rect->edge_u - rect->edge_v))};
    }
    if (const auto* disk = std::get_if<DiskLight>(&shape)) { return {disk->center, disk->radius}; }
    if (const auto* ball = std::get_if<SphereLight>(&shape)) {
        return {ball->center, ball->radius};
    }
    return {{}, std::numeric_limits<double>::infinity()};
}

}  // namespace

bool may_be_seen(const Lamp& lamp, Point3 p, Dir3 wi)
{
    const Vec3 to_centre = lamp.centre - p;
    const double along = dot(to_centre, wi), d2 = dot(to_centre, to_centre);
    constexpr double slack = 1e-12;  // some thousand roundings
    const double r2 = lamp.radius * lamp.radius * (1.0 + slack) + slack * d2;
    return d2 <= r2 || (along > 0.0 && d2 - along * along <= r2);
}

World world_of(const Stage& stage, const Scene& scene)
{
    World world{stage, scene, {}};
    for (std::size_t l = 0; l < scene.lights.size(); ++l) {
        const Light& light = scene.lights[l];
        if (!light.enabled) { continue; }
        Lamp lamp;
        lamp.light = &light;
        lamp.number = l;
        lamp.delta = is_delta(light.shape);
        lamp.shadowed = scene.transport.shadows && light.cast_shadows;
        std::tie(lamp.centre, lamp.radius) = ball_around(light.shape);
        lamp.dome = dome_of(light.shape);
        if (lamp.dome && lamp.dome->map == nullptr && !lamp.dome->sun) { continue; }  // dark
        const auto* sky = std::get_if<EnvironmentLight>(&light.shape);
        const bool is_face = std::holds_alternative<MeshLight>(light.shape);
        lamp.in_parts = is_face || std::holds_alternative<SkyLight>(light.shape);
        // A sky of one colour has nothing to aim at.
        lamp.by_light = !lamp.delta && (sky == nullptr || sky->map);
        // A ray meets the nearest face; where something before a face may not count, that is not
        // how to find it.
        lamp.by_surface =
            !lamp.delta && !(is_face && (!lamp.shadowed || scene.transport.max_distance));
        world.any_by_surface = world.any_by_surface || lamp.by_surface;
        world.any_faces = world.any_faces || (is_face && lamp.by_surface);
        world.lamps.push_back(lamp);
    }
    return world;
}

}  // namespace relight
