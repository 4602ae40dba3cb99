#include "core/shade/paths.h"

#include <algorithm>
#include <limits>
#include <span>
#include <utility>

#include "core/base/mis.h"
#include "core/shade/ask_lights.h"

namespace relight {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// The way a path goes on, drawn from the material.
struct Way {
    std::size_t path;
    Dir3 wi;
    double pdf;
    Rgb weight;  ///< the path's, with f cos / pdf of this place
    ShadowRay ray;
};

/// Whether a light that has no face in the mesh may lie that way.
bool may_lead_to_light(const World& world, Point3 p, Dir3 wi)
{
    return std::any_of(world.lamps.begin(), world.lamps.end(), [&](const Lamp& lamp) {
        return lamp.by_surface && may_be_seen(lamp, p, wi);
    });
}

/// Ways of the paths that go on: none that carries nothing.
/// @param all of them are wanted; else those that may lead to a light
std::vector<Way> choose_ways(const World& world, const Dimensions& dimensions,
                             std::span<const EyePath> paths, bool all)
{
    std::vector<Way> ways;
    ways.reserve(paths.size());
    for (std::size_t i = 0; i < paths.size(); ++i) {
        const EyePath& path = paths[i];
        const Seen& seen = path.seen;
        const BsdfSample drawn = sample(*seen.material, seen.wo, seen.color,
                                        path.sequence.at(path.point, dimensions.way),
                                        path.sequence.at(path.point, dimensions.way_pick).u);
        if (!(drawn.wi.z > 0.0)) { continue; }
        const Dir3 wi = normalize(seen.at.frame.to_world(drawn.wi));
        if (!wi || !is_above(seen, wi)) { continue; }
        if (!all && !may_lead_to_light(world, seen.at.p, wi)) { continue; }
        const Rgb weight = path.weight * ratio(response(seen, drawn.wi), drawn.pdf);
        if (is_black(weight)) { continue; }
        ways.push_back({i, wi, drawn.pdf, weight, ray_toward(world, seen, wi, infinite)});
    }
    return ways;
}

/// Ways that are looked along for lights.
struct Lookout {
    const World& world;
    std::span<const EyePath> paths;
    std::span<const Way> ways;
    std::span<const Hit> hits;  ///< what they meet; empty: not known
    RayQueue& queue;

    void look_for(const Lamp& lamp) const
    {
        if (lamp.dome) {
            look_along(
                *lamp.dome, ways.size(), [&](std::size_t w) { return ways[w].wi; },
                [&](std::size_t w, const LightSample& there) { find(lamp, w, there); });
            return;
        }
        const LightShape& shape = lamp.light->shape;
        const auto* faces = std::get_if<MeshLight>(&shape);
        for (std::size_t w = 0; w < ways.size(); ++w) {
            const Way& way = ways[w];
            const Point3 p = paths[way.path].seen.at.p;
            if (!may_be_seen(lamp, p, way.wi)) { continue; }
            find(lamp, w,
                 faces == nullptr ? look(shape, p, way.wi)
                                  : faces->table->look(hits[w].primitive, way.ray.origin, way.wi));
        }
    }

  private:
    /// The lamp shows `there` along a way.
    void find(const Lamp& lamp, std::size_t w, const LightSample& there) const
    {
        const Way& way = ways[w];
        const EyePath& path = paths[way.path];
        const double share = lamp.by_light ? mis::balance(1, way.pdf, 1, there.pdf) : 1.0;
        const Deposit found = deposit(path, lamp, way.weight * there.L * share);
        if (!there.wi || is_black(found.value)) { return; }
        const bool is_face = std::holds_alternative<MeshLight>(lamp.light->shape);
        // What the way meets tells whether a sky is seen; nearer lights have rays of their own.
        const bool is_told = !hits.empty() && !std::isfinite(there.distance);
        const bool is_open =
            is_told && (hits[w].primitive == ~0U || hits[w].distance > way.ray.distance);
        if (is_face || !lamp.shadowed || is_open) {
            found.give();
        } else if (!is_told) {
            queue.ask(ray_toward(world, path.seen, way.wi, there.distance), found);
        }
    }
};

/// What the ways meet.
std::vector<Hit> meet(const World& world, std::span<const Way> ways, RayQueue& queue)
{
    std::vector<ShadowRay> rays;
    rays.reserve(ways.size());
    for (const Way& way : ways) {
        rays.push_back(way.ray);
        rays.back().distance = infinite;
    }
    std::vector<Hit> hits(rays.size());
    world.stage.bvh->nearest(rays, hits);
    queue.count(rays.size());
    return hits;
}

/// Where the ways lead to, as places to look for light in.
std::vector<EyePath> arrived(const World& world, std::span<const EyePath> paths,
                             std::span<const Way> ways, std::span<const Hit> hits)
{
    std::vector<EyePath> on;
    on.reserve(ways.size());
    for (std::size_t w = 0; w < ways.size(); ++w) {
        if (hits[w].primitive == ~0U) { continue; }
        const Way& way = ways[w];
        const EyePath& path = paths[way.path];
        EyePath next{see(world.stage, world.scene, way.ray.origin, way.wi, hits[w]), way.weight,
                     path.sums, path.sequence, path.point};
        if (next.seen.is_there()) { on.push_back(std::move(next)); }
    }
    return on;
}

}  // namespace

void follow(const World& world, std::vector<EyePath> paths, RayQueue& queue)
{
    const unsigned bounces = world.scene.transport.bounces;
    for (unsigned depth = 0; !paths.empty(); ++depth) {
        const Dimensions dimensions(depth, world.scene.lights.size());
        ask_lights(world, dimensions, paths, queue);
        const bool last = depth == bounces;
        if (last && !world.any_by_surface) { break; }
        const bool must_meet = !last || world.any_faces;
        const std::vector<Way> ways = choose_ways(world, dimensions, paths, must_meet);
        const std::vector<Hit> hits = must_meet ? meet(world, ways, queue) : std::vector<Hit>{};
        const Lookout lookout{world, paths, ways, hits, queue};
        for (const Lamp& lamp : world.lamps) {
            if (lamp.by_surface) { lookout.look_for(lamp); }
        }
        if (last) { break; }
        paths = arrived(world, paths, ways, hits);
    }
    queue.flush();
}

}  // namespace relight
