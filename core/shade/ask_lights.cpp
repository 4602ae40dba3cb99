#include "core/shade/ask_lights.h"

#include <algorithm>
#include <array>

#include "core/base/mis.h"

namespace relight {
namespace {

/// A lamp that is looked for at many places.
class Lighting {
  public:
    Lighting(const World& world, const Lamp& lamp, const Dimensions& dimensions, RayQueue& queue)
        : world_(world),
          lamp_(lamp),
          queue_(queue),
          pair_(dimensions.light(lamp)),
          pick_(dimensions.light_pick(lamp))
    {
    }

    void delta(std::span<const EyePath> paths)
    {
        for (const EyePath& path : paths) {
            const Seen& seen = path.seen;
            const Arrival arrival = arrive(lamp_.light->shape, seen.at.p);
            if (!(arrival.per_unit > 0.0) || !is_above(seen, arrival.wi)) { continue; }
            const double E_perp = per_unit_m2(arrival, world_.scene.length_unit_m);
            ask(path, arrival.wi, arrival.distance,
                path.weight * response(seen, seen.at.frame.to_local(arrival.wi)) * E_perp);
        }
    }

    /// One by one.
    void sampled(std::span<const EyePath> paths)
    {
        const LightShape& shape = lamp_.light->shape;
        for (const EyePath& path : paths) {
            drawn(path, sample(shape, path.seen.at.p, place(path), pick(path)));
        }
    }

    void rect(std::span<const EyePath> paths, const RectLight& rect)
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
                const Sample2 s = place(some[i]);
                drawn(some[i],
                      seen.is_seen() ? seen.sample_direction(s) : sample(rect, places[i], s));
            }
        }
    }

    void dome(std::span<const EyePath> paths, const Dome& dome)
    {
        DomeLanes lanes;
        for (; !paths.empty(); paths = paths.subspan(std::min(DomeLanes::most, paths.size()))) {
            const auto some = paths.first(std::min(DomeLanes::most, paths.size()));
            for (std::size_t i = 0; i < some.size(); ++i) {
                const Sample2 s = place(some[i]);
                lanes.u[i] = s.u;
                lanes.v[i] = s.v;
                lanes.pick[i] = pick(some[i]);
            }
            sample(dome, some.size(), lanes);
            for (std::size_t i = 0; i < some.size(); ++i) { drawn(some[i], sample_in(lanes, i)); }
        }
    }

  private:
    Sample2 place(const EyePath& path) const { return path.sequence.at(path.point, pair_); }
    /// Of a part, where there are parts.
    double pick(const EyePath& path) const
    {
        return lamp_.in_parts ? path.sequence.at(path.point, pick_).u : 0.0;
    }

    void ask(const EyePath& path, Dir3 wi, double distance, Rgb value)
    {
        const Deposit found = deposit(path, lamp_, value);
        if (is_black(found.value)) { return; }
        if (!lamp_.shadowed) { return found.give(); }
        queue_.ask(ray_toward(world_, path.seen, wi, distance), found);
    }

    void drawn(const EyePath& path, const LightSample& there)
    {
        const Seen& seen = path.seen;
        if (!there.wi || !is_above(seen, there.wi)) { return; }
        const Vec3 wi = seen.at.frame.to_local(there.wi);
        const double by_surface =
            lamp_.by_surface ? pdf(*seen.material, wi, seen.wo, seen.color) : 0.0;
        const double share = mis::balance(1, there.pdf, 1, by_surface);
        const bool is_face = std::holds_alternative<MeshLight>(lamp_.light->shape);
        const double distance =
            is_face ? short_of_face(*world_.stage.bvh, there.distance) : there.distance;
        ask(path, there.wi, distance,
            path.weight * ratio(there.L * response(seen, wi) * share, there.pdf));
    }

    const World& world_;
    const Lamp& lamp_;
    RayQueue& queue_;
    std::uint32_t pair_, pick_;
};

}  // namespace

void ask_lights(const World& world, const Dimensions& dimensions, std::span<const EyePath> paths,
                RayQueue& queue)
{
    for (const Lamp& lamp : world.lamps) {
        Lighting lighting(world, lamp, dimensions, queue);
        if (lamp.delta) {
            lighting.delta(paths);
        } else if (const auto* rect = std::get_if<RectLight>(&lamp.light->shape)) {
            lighting.rect(paths, *rect);
        } else if (lamp.dome) {
            lighting.dome(paths, *lamp.dome);
        } else if (lamp.by_light) {
            lighting.sampled(paths);
        }
    }
}

}  // namespace relight
