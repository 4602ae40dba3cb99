#include "core/shade/paths.h"

#include <cmath>
#include <limits>

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
    Dir3 wi;
    double pdf = 0.0;
    Rgb weight;  ///< the path's, with f cos / pdf of this place
    ShadowRay ray;
};

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
    void ask_lights(const EyePath& path)
    {
        for (const Lamp& lamp : world_.lamps) {
            if (lamp.delta) {
                ask_delta(path, lamp);
            } else if (lamp.by_light) {
                ask_sampled(path, lamp);
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
        way.wi = normalize(seen.at.frame.to_world(drawn.wi));
        way.pdf = drawn.pdf;
        way.weight = path.weight * ratio(response(seen, drawn.wi), drawn.pdf);
        if (!way.wi || is_black(way.weight) || !is_above(seen, way.wi)) { return false; }
        way.ray = ray_toward(seen, way.wi, infinite);
        return true;
    }

    /// The lights that the way leads to. `hit`: what it meets; null: not known.
    void look_along(const EyePath& path, const Way& way, const Hit* hit)
    {
        for (const Lamp& lamp : world_.lamps) {
            if (!lamp.by_surface) { continue; }
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

    void ask_sampled(const EyePath& path, const Lamp& lamp)
    {
        const Seen& seen = path.seen;
        const std::uint32_t pair =
            first_pair_ + first_light + 2 * static_cast<std::uint32_t>(lamp.number);
        const LightSample there =
            sample(lamp.light->shape, seen.at.p, path.sequence.at(path.point, pair),
                   path.sequence.at(path.point, pair + 1).u);
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

World world_of(const Stage& stage, const Scene& scene)
{
    World world{stage, scene, {}};
    for (std::size_t l = 0; l < scene.lights.size(); ++l) {
        const Light& light = scene.lights[l];
        if (!light.enabled) { continue; }
        Lamp lamp{&light, l, is_delta(light.shape), scene.transport.shadows && light.cast_shadows};
        const auto* sky = std::get_if<EnvironmentLight>(&light.shape);
        const bool is_face = std::holds_alternative<MeshLight>(light.shape);
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
        ways.clear();
        for (std::size_t i = 0; i < paths.size(); ++i) {
            follower.ask_lights(paths[i]);
            Way way;
            way.path = i;
            if ((!last || world.any_by_surface) && follower.choose_way(paths[i], way)) {
                ways.push_back(way);
            }
        }
        const bool meet = !last || world.any_faces;
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
            const auto seen = see(world.stage, world.scene, rays[w].origin, ways[w].wi, hits[w]);
            if (!seen) { continue; }
            on.push_back({*seen, ways[w].weight, path.sums, path.sequence, path.point});
        }
        paths = std::move(on);
    }
    queue.flush();
}

}  // namespace relight
