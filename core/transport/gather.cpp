#include "core/transport/gather.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "core/base/warp.h"

namespace relight {
namespace {

// Pairs of dimensions of a sequence, by what they decide.
enum Pair : std::uint32_t {
    light_pair,
    light_pick,
    response_pair,
    response_pick,
    path_pair,
    path_pick,
    first_bounce,  // and three for each: where light is looked for, its pick, where the path goes
};
constexpr std::uint32_t pairs_per_bounce = 3;

/// The ray that says whether a light's sample is seen; toward a shining face it stops before it.
ShadowRay ray_toward(const Source& source, const Receiver& receiver, const LightSample& there)
{
    const Bvh& bvh = *source.stage.bvh;
    const bool on_mesh = std::holds_alternative<MeshLight>(source.light.shape);
    const double distance = on_mesh ? short_of_face(bvh, there.distance) : there.distance;
    return shadow_ray(bvh, receiver, there.wi, distance, source.scene.transport);
}

}  // namespace

std::uint64_t key_of(const Receiver& receiver)
{
    std::uint64_t key = 0;
    const Vec3 n = receiver.frame.n;
    for (const double x : {receiver.p.x, receiver.p.y, receiver.p.z, n.x, n.y, n.z}) {
        key = sobol::mix(key, std::bit_cast<std::uint64_t>(x + 0.0));  // -0 is 0
    }
    return key;
}

bool is_even_sky(const LightShape& shape)
{
    const auto* sky = std::get_if<EnvironmentLight>(&shape);
    return sky != nullptr && (!sky->map || sky->map->is_even());
}

Rgb Response::value(Vec3 wi) const
{
    if (two_sided_) { wi.z = std::abs(wi.z); }
    if (!(wi.z > 0.0)) { return {}; }
    return material_ == nullptr ? Rgb::grey(wi.z) : f(*material_, wi, wo_, color_).value * wi.z;
}

double Response::pdf(Vec3 wi) const
{
    if (two_sided_) { wi.z = std::abs(wi.z); }
    const double above = material_ == nullptr ? warp::cosine_hemisphere_pdf(wi.z)
                                              : relight::pdf(*material_, wi, wo_, color_);
    return two_sided_ ? 0.5 * above : above;
}

Vec3 Response::sample(Sample2 s, Sample2 pick) const
{
    Vec3 wi = material_ == nullptr ? warp::cosine_hemisphere(s)
                                   : relight::sample(*material_, wo_, color_, s, pick.u).wi;
    if (two_sided_) { wi.z = std::copysign(wi.z, pick.v - 0.5); }
    return wi;
}

void gather_direct(const Source& source, const Receiver& receiver, const LightView& view,
                   const Response& response, const Sequence& sequence, unsigned begin, unsigned end,
                   Rgb& lit, Unblocked* seen, RayQueue& queue)
{
    const LightShape& shape = source.light.shape;
    const auto* faces = std::get_if<MeshLight>(&shape);
    const bool shadowed = source.shadowed();
    const bool response_only = is_even_sky(shape);
    // A face seen along a ray is the light only where the ray meets it first, whatever is between.
    const bool light_only =
        faces != nullptr && (!shadowed || source.scene.transport.max_distance.has_value());
    const bool parts = faces != nullptr || std::holds_alternative<SkyLight>(shape);
    const double share = light_only || response_only ? 1.0 : 0.5;  // of the points, each way
    const auto density = [&](double by_light, double by_response) {
        return (response_only ? 0.0 : share * by_light) + (light_only ? 0.0 : share * by_response);
    };
    const auto deposit = [&](const LightSample& there, Rgb value) {
        if (is_black(value)) { return; }
        if (seen != nullptr) { seen->total += luminance(value); }
        const Deposit one{&lit, value, seen != nullptr ? &seen->open : nullptr};
        if (!shadowed) { return one.give(); }
        queue.ask(ray_toward(source, receiver, there), one);
    };
    for (unsigned point = begin; point < end; ++point) {
        // Each way takes the points of its sequence in their order: its own net.
        const unsigned i = light_only || response_only ? point : point / 2;
        if (!response_only && (light_only || point % 2 == 0)) {
            const double pick = parts ? sequence.at(i, light_pick).u : 0.0;
            const LightSample there = sample(view, sequence.at(i, light_pair), pick);
            if (!there.wi) { continue; }
            const Vec3 wi = receiver.frame.to_local(there.wi);
            const Rgb value = there.L * response.value(wi);
            if (is_black(value)) { continue; }
            deposit(there, ratio(value, density(there.pdf, light_only ? 0.0 : response.pdf(wi))));
            continue;
        }
        const Vec3 local =
            response.sample(sequence.at(i, response_pair),
                            response.picks() ? sequence.at(i, response_pick) : Sample2{});
        const double by_response = response.pdf(local);
        const Dir3 wi = normalize(receiver.frame.to_world(local));
        if (!(by_response > 0.0) || !wi) { continue; }
        if (faces != nullptr) {
            const ShadowRay ray =
                shadow_ray(*source.stage.bvh, receiver, wi, std::numeric_limits<double>::infinity(),
                           source.scene.transport);
            const Hit hit = source.stage.bvh->nearest(ray.origin, ray.direction, ray.from);
            queue.count(1);
            if (hit.primitive == ~0U) { continue; }
            const LightSample there = faces->table->look(hit.primitive, receiver.p, wi);
            lit += ratio(there.L * response.value(local), density(there.pdf, by_response));
            continue;
        }
        const LightSample there = look(view, wi);
        if (is_black(there.L)) { continue; }
        deposit(there, ratio(there.L * response.value(local), density(there.pdf, by_response)));
    }
}

namespace {

/// Draws the points of `lanes` for as many of the vertices as fit a stream at a time, which ask as
/// `ask(vertex)` says, and has the rays traced if they are `shadowed`. `weigh(fields, E, slots)`
/// may change what they bring before, and `settle(vertex, lanes, first slot, blocked, E)` says what
/// comes of each vertex's.
template <class Vertex, class Ask, class Weigh, class Settle>
std::uint64_t ask_for_all(const Source& source, std::span<const Vertex> vertices,
                          std::uint32_t pair, std::span<const Lanes> lanes, ShadowStream& stream,
                          const Ask& ask, const Weigh& weigh, const Settle& settle)
{
    using View = std::decay_t<decltype(ask(vertices[0]))>;
    const Bvh& bvh = *source.stage.bvh;
    std::vector<Asker<View>> askers;
    std::array<std::uint8_t, ShadowStream::capacity> open{};
    Brought E;
    std::uint64_t rays = 0;
    const std::size_t together = askers_a_stream(lanes[0]);  // the later have no more lanes
    for (std::size_t begin = 0; begin < vertices.size(); begin += together) {
        const auto some = vertices.subspan(begin, std::min(together, vertices.size() - begin));
        askers.clear();
        for (const Vertex& v : some) {
            askers.push_back({ask(v), v.receiver, source.sequence(*v.receiver)});
        }
        for (const Lanes& points : lanes) {
            draw<View>(askers, bvh, source.scene.transport, pair, points, stream, E);
            weigh(stream.fields(), E, stream.size());
            std::span<const std::uint8_t> blocked = std::span(open).first(stream.size());
            if (source.shadowed()) {
                blocked = stream.trace();
                rays += static_cast<std::uint64_t>(std::count_if(
                    E.begin(), E.begin() + static_cast<std::ptrdiff_t>(blocked.size()),
                    [](double brought) { return brought > 0.0; }));
            } else {
                stream.resize(0);
            }
            std::size_t slot = 0;
            for (const Vertex& v : some) {
                settle(v, points, slot, blocked.subspan(slot, points.count),
                       std::span(E).subspan(slot, points.count));
                slot += points.count;
            }
        }
    }
    return rays;
}

}  // namespace

std::uint64_t gather_irradiance(const Source& source, std::span<const GreyVertex> vertices,
                                std::span<const Lanes> lanes, ShadowStream& stream)
{
    if (vertices.empty()) { return 0; }
    const auto gather = [&](std::span<const GreyVertex> some, std::uint32_t pair, const auto& ask) {
        return ask_for_all(
            source, some, pair, lanes, stream, ask,
            [](const RayFields& /*fields*/, const Brought& /*E*/, std::size_t /*slots*/) {},
            [](const GreyVertex& v, const Lanes& points, std::size_t /*slot*/,
               std::span<const std::uint8_t> blocked, std::span<const double> E) {
                unsigned rays = 0;
                for (unsigned i = 0; i < points.count; ++i) {
                    const unsigned r = points.replicate[i];
                    v.all[r] += E[i];
                    v.lit[r] += blocked[i] == 0 ? E[i] : 0.0;
                    rays += E[i] > 0.0 ? 1 : 0;
                }
                *v.rays += rays;
            });
    };
    const LightShape& shape = source.light.shape;
    if (const auto* rect = std::get_if<RectLight>(&shape)) {
        std::vector<Point3> places;
        for (const GreyVertex& v : vertices) { places.push_back(v.receiver->p); }
        std::vector<RectDirections> seen(vertices.size());
        directions(*rect, places, seen);
        std::vector<GreyVertex> usual, others;
        std::vector<RectDirections> of_usual;
        for (std::size_t v = 0; v < vertices.size(); ++v) {
            if (seen[v].whole < 0.0) {
                others.push_back(vertices[v]);
                continue;
            }
            usual.push_back(vertices[v]);
            of_usual.push_back(seen[v]);
        }
        std::size_t next = 0;
        return gather(usual, light_pair,
                      [&](const GreyVertex& /*v*/) { return of_usual[next++]; }) +
               gather(others, light_pair,
                      [&](const GreyVertex& v) { return RectView(*rect, v.receiver->p); });
    }
    if (const auto* disk = std::get_if<DiskLight>(&shape)) {
        return gather(vertices, light_pair,
                      [&](const GreyVertex& v) { return DiskView(*disk, v.receiver->p); });
    }
    if (const auto* ball = std::get_if<SphereLight>(&shape)) {
        return gather(vertices, light_pair,
                      [&](const GreyVertex& v) { return SphereView(*ball, v.receiver->p); });
    }
    if (const auto* sun = std::get_if<DirectionalLight>(&shape)) {
        const SunView view(*sun);
        return gather(vertices, light_pair, [&](const GreyVertex& /*v*/) { return view; });
    }
    return gather(vertices, response_pair, [&](const GreyVertex& v) {
        return CosineView(v.receiver->frame, source.scene.transport.two_sided);
    });
}

std::optional<Dome> dome_of(const LightShape& shape)
{
    if (const auto* sky = std::get_if<SkyLight>(&shape)) { return relight::dome_of(*sky); }
    const auto* environment = std::get_if<EnvironmentLight>(&shape);
    if (environment == nullptr || !environment->map) { return {}; }
    return relight::dome_of(*environment);
}

std::uint64_t gather_dome(const Source& source, const Dome& dome,
                          std::span<const ColoredVertex> vertices, unsigned replicates,
                          unsigned begin, unsigned end, ShadowStream& stream)
{
    if (vertices.empty() || (dome.map == nullptr && !dome.sun)) { return 0; }
    const bool even = is_even_sky(source.light.shape);
    const double sides = source.scene.transport.two_sided ? 2.0 : 1.0;
    const double light_share = even ? 0.0 : 0.5, response_share = even ? 1.0 : 0.5;
    DomeLanes seen;
    const auto weigh = [&](RayFields& fields, Brought& cosines, std::size_t slots) {
        std::copy_n(fields.direction_x.begin(), slots, seen.x);
        std::copy_n(fields.direction_y.begin(), slots, seen.y);
        std::copy_n(fields.direction_z.begin(), slots, seen.z);
        look(dome, slots, seen);
        for (std::size_t slot = 0; slot < slots; ++slot) {
            const double cos_i = cosines[slot];
            const double density = light_share * seen.pdf[slot] +
                                   response_share * warp::cosine_hemisphere_pdf(cos_i) / sides;
            Rgb& value = seen.L[slot];
            value = ratio(value * cos_i, density);
            cosines[slot] = luminance(value);
            if (is_black(value)) { fields.tfar[slot] = -std::numeric_limits<float>::infinity(); }
        }
    };
    const auto settle = [&](const ColoredVertex& v, const Lanes& points, std::size_t slot,
                            std::span<const std::uint8_t> blocked, std::span<const double> E) {
        for (unsigned i = 0; i < points.count; ++i) {
            if (!(E[i] > 0.0)) { continue; }
            v.seen->total += E[i];
            if (blocked[i] != 0) { continue; }
            v.seen->open += E[i];
            v.lit[points.replicate[i]] += seen.L[slot + i];
        }
    };
    const unsigned ways = even ? 1 : 2;  // each takes the points of its sequence in their order
    const auto lanes = lanes_of(replicates, begin / ways, end / ways);
    std::uint64_t rays = 0;
    if (!even) {
        rays += ask_for_all(
            source, vertices, light_pair, lanes, stream,
            [&](const ColoredVertex& /*v*/) { return DomeDirections{&dome}; }, weigh, settle);
    }
    const auto by_cosine = [&](const ColoredVertex& v) {
        return CosineDirections{CosineView(v.receiver->frame, source.scene.transport.two_sided)};
    };
    return rays +
           ask_for_all(source, vertices, response_pair, lanes, stream, by_cosine, weigh, settle);
}

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
