#include <algorithm>
#include <limits>
#include <numbers>

#include "core/base/warp.h"
#include "core/transport/gather.h"

namespace relight {
namespace {

/// Direct E at a bounce, from one draw of the light, times `weight`.
void pick_up(const Source& source, const Path& path, Rgb weight, std::uint32_t pair,
             RayQueue& queue)
{
    const LightShape& shape = source.light.shape;
    const Receiver& at = path.at;
    LightSample there;
    Rgb E;
    if (is_delta(shape)) {
        const Arrival arrival = arrive(shape, at.p);
        there.wi = arrival.wi;
        there.distance = arrival.distance;
        E = Rgb::grey(std::max(0.0, dot(at.ng, arrival.wi)) *
                      per_unit_m2(arrival, source.scene.length_unit_m));
    } else if (is_even_sky(shape)) {
        const Vec3 local = warp::cosine_hemisphere(path.sequence.at(path.point, pair));
        there = look(shape, at.p, normalize(at.frame.to_world(local)));
        E = there.L * std::numbers::pi;
    } else {
        there = sample(shape, at.p, path.sequence.at(path.point, pair),
                       path.sequence.at(path.point, pair + 1).u);
        E = ratio(there.L * std::max(0.0, dot(at.ng, there.wi)), there.pdf);
    }
    const Deposit deposit{path.bounced, weight * E};
    if (!there.wi || is_black(deposit.value)) { return; }
    if (!source.shadowed()) { return deposit.give(); }
    queue.ask(ray_toward(source, at, there), deposit);
}

}  // namespace

void start_path(const Receiver& receiver, const Response& response, const Sequence& sequence,
                unsigned point, Rgb& bounced, std::vector<Path>& paths)
{
    const Vec3 local =
        response.sample(sequence.at(point, path_pair), sequence.at(point, path_pick));
    const Rgb weight = ratio(response.value(local), response.pdf(local));
    const Dir3 wi = normalize(receiver.frame.to_world(local));
    if (is_black(weight) || !wi) { return; }
    paths.push_back({receiver, wi, weight, &bounced, sequence, point});
}

void follow(const Source& source, std::vector<Path> paths, unsigned bounces, RayQueue& queue)
{
    const Stage& stage = source.stage;
    std::vector<ShadowRay> rays;
    std::vector<Hit> hits;
    for (unsigned bounce = 0; bounce < bounces && !paths.empty(); ++bounce) {
        rays.clear();
        for (const Path& path : paths) {
            rays.push_back(shadow_ray(*stage.bvh, path.at, path.wi,
                                      std::numeric_limits<double>::infinity(),
                                      source.scene.transport));
            rays.back().distance = std::numeric_limits<double>::infinity();
        }
        hits.resize(rays.size());
        stage.bvh->nearest(rays, hits);
        queue.count(rays.size());
        std::vector<Path> on;
        for (std::size_t i = 0; i < paths.size(); ++i) {
            const Hit& hit = hits[i];
            if (hit.primitive == ~0U) { continue; }
            Path path = paths[i];
            const Rgb rho =
                diffuse_albedo(*material_at(stage, source.scene, hit), color_at(stage, hit));
            path.weight = path.weight * rho;
            path.at = hit_receiver(stage, rays[i].origin, rays[i].direction, hit);
            if (is_black(path.weight) || !path.at.ng) { continue; }
            const std::uint32_t pair = first_bounce + bounce * pairs_per_bounce;
            pick_up(source, path, path.weight * std::numbers::inv_pi, pair, queue);
            const Vec3 local = warp::cosine_hemisphere(path.sequence.at(path.point, pair + 2));
            path.wi = normalize(path.at.frame.to_world(local));
            if (path.wi) { on.push_back(path); }
        }
        paths = std::move(on);
    }
}

}  // namespace relight
