#include "core/shade/paths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <tuple>
#include <utility>

#include "core/base/mis.h"

namespace relight {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

// Pairs of dimensions of a path's sequence: at each place two for the way on and two a light.
constexpr std::uint32_t way_pair = 0, way_pick = 1, first_light = 2;

/// f cos, toward the eye.
Rgb response(const Seen& seen, Vec3 wi)
{
    return f(*seen.material, wi, seen.wo, seen.color).value * wi.z;
}

/// The way a path goes on, drawn from the material.
struct Way {
    std::size_t path = 0;
    Vec3 local;  ///< in the frame of the place
    Dir3 wi;
    double pdf = 0.0;
    Rgb weight;  ///< the path's, with f cos / pdf of this place
    ShadowRay ray;
};

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
    return {{}, infinite};
}

class Follower {
  public:
    Follower(const World& world, std::uint32_t depth, RayQueue& queue)
        : world_(world),
          queue_(queue),
          first_pair_(depth *
                      (first_light + 2 * static_cast<std::uint32_t>(world.scene.lights.size())))
    {
    }

    /// Light by directions that the lights choose.
    void ask_lights(std::span<const EyePath> paths)
    {
        for (const Lamp& lamp : world_.lamps) {
            if (lamp.delta) {
                for (const EyePath& path : paths) { ask_delta(path, lamp); }
            } else if (const auto* rect = std::get_if<RectLight>(&lamp.light->shape)) {
                ask_rect(paths, lamp, *rect);
            } else if (lamp.by_light) {
                for (const EyePath& path : paths) {
                    const auto [s, pick] = draw_for(path, lamp);
                    ask_sampled(path, lamp, sample(lamp.light->shape, path.seen.at.p, s, pick));
                }
            }
        }
    }

    /// false: it ends here.
    bool choose_way(const EyePath& path, Way& way) const
    {
        const Seen& seen = path.seen;
        const BsdfSample drawn = sample(*seen.material, seen.wo, seen.color,
                                        path.sequence.at(path.point, first_pair_ + way_pair),
                                        path.sequence.at(path.point, first_pair_ + way_pick).u);
        if (!(drawn.wi.z > 0.0)) { return false; }
        way.local = drawn.wi;
        way.wi = normalize(seen.at.frame.to_world(drawn.wi));
        way.pdf = drawn.pdf;
        return way.wi && is_above(seen, way.wi);
    }

    /// Whether a light that has no face in the mesh may lie on the way.
    bool may_lead_to_light(const EyePath& path, const Way& way) const
    {
        return std::any_of(world_.lamps.begin(), world_.lamps.end(), [&](const Lamp& lamp) {
            return lamp.by_surface && may_be_seen(lamp, path.seen.at.p, way.wi);
        });
    }

    /// What the way carries. false: nothing.
    bool weigh(const EyePath& path, Way& way) const
    {
        way.weight = path.weight * ratio(response(path.seen, way.local), way.pdf);
        if (is_black(way.weight)) { return false; }
        way.ray = ray_toward(path.seen, way.wi, infinite);
        return true;
    }

    /// The lights that the way leads to. `hit`: what it meets; null: not known.
    void look_along(const EyePath& path, const Way& way, const Hit* hit)
    {
        for (const Lamp& lamp : world_.lamps) {
            if (!lamp.by_surface || !may_be_seen(lamp, path.seen.at.p, way.wi)) { continue; }
            const LightShape& shape = lamp.light->shape;
            const auto* faces = std::get_if<MeshLight>(&shape);
            const LightSample there =
                faces == nullptr ? look(shape, path.seen.at.p, way.wi)
                                 : faces->table->look(hit->primitive, way.ray.origin, way.wi);
            const double share = lamp.by_light ? mis::balance(1, way.pdf, 1, there.pdf) : 1.0;
            const Deposit found = deposit(path, lamp, way.weight * there.L * share);
            if (!there.wi || is_black(found.value)) { continue; }
            // What the way meets tells whether a sky is seen; nearer lights have rays of their own.
            const bool is_told = hit != nullptr && !std::isfinite(there.distance);
            const bool is_open =
                is_told && (hit->primitive == ~0U || hit->distance > way.ray.distance);
            if (faces != nullptr || !lamp.shadowed || is_open) {
                found.give();
            } else if (!is_told) {
                queue_.ask(ray_toward(path.seen, way.wi, there.distance), found);
            }
        }
    }

  private:
    ShadowRay ray_toward(const Seen& seen, Dir3 wi, double distance) const
    {
        return shadow_ray(*world_.stage.bvh, seen.at, wi, distance, world_.scene.transport);
    }

    static Deposit deposit(const EyePath& path, const Lamp& lamp, Rgb value)
    {
        return {path.sums + lamp.number, value * lamp.light->power};
    }

    void ask(const EyePath& path, const Lamp& lamp, Dir3 wi, double distance, Rgb value)
    {
        const Deposit found = deposit(path, lamp, value);
        if (is_black(found.value)) { return; }
        if (!lamp.shadowed) { return found.give(); }
        queue_.ask(ray_toward(path.seen, wi, distance), found);
    }

    void ask_delta(const EyePath& path, const Lamp& lamp)
    {
        const Seen& seen = path.seen;
        const Arrival arrival = arrive(lamp.light->shape, seen.at.p);
        if (!(arrival.per_unit > 0.0) || !is_above(seen, arrival.wi)) { return; }
        const double E_perp = per_unit_m2(arrival, world_.scene.length_unit_m);
        ask(path, lamp, arrival.wi, arrival.distance,
            path.weight * response(seen, seen.at.frame.to_local(arrival.wi)) * E_perp);
    }

    struct Draw {
        Sample2 s;
        double pick;  ///< of a part, where there are parts
    };
    Draw draw_for(const EyePath& path, const Lamp& lamp) const
    {
        const std::uint32_t pair =
            first_pair_ + first_light + 2 * static_cast<std::uint32_t>(lamp.number);
        return {path.sequence.at(path.point, pair),
                lamp.in_parts ? path.sequence.at(path.point, pair + 1).u : 0.0};
    }

    void ask_rect(std::span<const EyePath> paths, const Lamp& lamp, const RectLight& rect)
    {
        constexpr std::size_t most = 64;  // together: some kilobytes
        std::array<Point3, most> places;
        std::array<RectDirections, most> rects;
        for (; !paths.empty(); paths = paths.subspan(std::min(most, paths.size()))) {
            const auto some = paths.first(std::min(most, paths.size()));
            std::transform(some.begin(), some.end(), places.begin(),
                           [](const EyePath& path) { return path.seen.at.p; });
            directions(rect, {places.data(), some.size()}, {rects.data(), some.size()});
            for (std::size_t i = 0; i < some.size(); ++i) {
                const RectDirections& seen = rects[i];
                if (seen.whole == 0.0) { continue; }
                const Sample2 s = draw_for(some[i], lamp).s;
                ask_sampled(some[i], lamp,
                            seen.is_seen() ? seen.sample_direction(s) : sample(rect, places[i], s));
            }
        }
    }

    void ask_sampled(const EyePath& path, const Lamp& lamp, const LightSample& there)
    {
        const Seen& seen = path.seen;
        if (!there.wi || !is_above(seen, there.wi)) { return; }
        const Vec3 wi = seen.at.frame.to_local(there.wi);
        const double by_surface =
            lamp.by_surface ? pdf(*seen.material, wi, seen.wo, seen.color) : 0.0;
        const double share = mis::balance(1, there.pdf, 1, by_surface);
        const bool is_face = std::holds_alternative<MeshLight>(lamp.light->shape);
        const double distance =
            is_face ? short_of_face(*world_.stage.bvh, there.distance) : there.distance;
        ask(path, lamp, there.wi, distance,
            path.weight * ratio(there.L * response(seen, wi) * share, there.pdf));
    }

    const World& world_;
    RayQueue& queue_;
    std::uint32_t first_pair_;  // of this place
};

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

void follow(const World& world, std::vector<EyePath> paths, RayQueue& queue)
{
    const Bvh& bvh = *world.stage.bvh;
    const unsigned bounces = world.scene.transport.bounces;
    std::vector<Way> ways;
    std::vector<ShadowRay> rays;
    std::vector<Hit> hits;
    for (unsigned depth = 0; !paths.empty(); ++depth) {
        const bool last = depth == bounces;
        Follower follower(world, depth, queue);
        follower.ask_lights(paths);
        const bool meet = !last || world.any_faces;
        ways.clear();
        for (std::size_t i = 0; i < paths.size() && (!last || world.any_by_surface); ++i) {
            Way way;
            way.path = i;
            if (follower.choose_way(paths[i], way) &&
                (meet || follower.may_lead_to_light(paths[i], way)) &&
                follower.weigh(paths[i], way)) {
                ways.push_back(way);
            }
        }
        if (meet) {
            rays.clear();
            for (const Way& way : ways) {
                rays.push_back(way.ray);
                rays.back().distance = infinite;
            }
            hits.resize(rays.size());
            bvh.nearest(rays, hits);
            queue.count(rays.size());
        }
        std::vector<EyePath> on;
        for (std::size_t w = 0; w < ways.size(); ++w) {
            const EyePath& path = paths[ways[w].path];
            follower.look_along(path, ways[w], meet ? &hits[w] : nullptr);
            if (last || hits[w].primitive == ~0U) { continue; }
            auto seen = see(world.stage, world.scene, rays[w].origin, ways[w].wi, hits[w]);
            if (!seen) { continue; }
            on.push_back({std::move(*seen), ways[w].weight, path.sums, path.sequence, path.point});
        }
        paths = std::move(on);
    }
    queue.flush();
}

}  // namespace relight
