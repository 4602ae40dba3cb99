#include <algorithm>
#include <limits>

#include "core/base/vectors.h"
#include "core/base/warp.h"
#include "core/transport/gather.h"

namespace relight {
namespace {

/// Draws the points of `lanes` for as many of the vertices as fit a stream at a time, which ask as
/// `ask(vertex)` says, and has the rays traced if they are `shadowed`. `weigh(fields, E, slots)`
/// may change what they bring before, and `settle(vertex, lanes, first slot, blocked, E)` makes of
/// each vertex's what comes of them, and counts those that bring something.
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
    askers.reserve(std::min(together, vertices.size()));
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
            } else {
                stream.resize(0);
            }
            std::size_t slot = 0;
            for (const Vertex& v : some) {
                const unsigned asked = settle(v, points, slot, blocked.subspan(slot, points.count),
                                              std::span(E).subspan(slot, points.count));
                if (source.shadowed()) { rays += asked; }
                slot += points.count;
            }
        }
    }
    return rays;
}

/// What each way of two takes of points [begin, end): in the order of its sequence; all of one.
std::vector<Lanes> lanes_of_ways(double light_share, unsigned replicates, unsigned begin,
                                 unsigned end)
{
    const unsigned ways = light_share > 0.0 && light_share < 1.0 ? 2 : 1;
    return lanes_of(replicates, begin / ways, end / ways);
}

/// Points drawn from the light and by the cosine, each as often as `light_share` says, joined.
/// `seen` is what is seen along the directions of a stream: drawing them leaves it there, or
/// look_up(fields, slots) for those by the cosine.
template <class ByLight, class ByCosine, class LookUp>
std::uint64_t gather_joined(const Source& source, std::span<const ColoredVertex> vertices,
                            const std::vector<Lanes>& lanes, double light_share,
                            ShadowStream& stream, SeenLanes& seen, const ByLight& by_light,
                            const ByCosine& by_cosine, const LookUp& look_up)
{
    const bool two_sided = source.scene.transport.two_sided;
    const double cosine_share = (1.0 - light_share) / (two_sided ? 2.0 : 1.0);
    const auto weigh = [&](RayFields& fields, Brought& cosines, std::size_t slots) {
        in_vectors([&] {
            const double by_light_alone = light_share, by_cosine_alone = cosine_share;
            RELIGHT_APART
            for (std::size_t slot = 0; slot < slots; ++slot) {
                const double cos_i = cosines[slot];
                const double density = by_light_alone * seen.pdf[slot] +
                                       by_cosine_alone * warp::cosine_hemisphere_pdf(cos_i);
                const Mask is_drawn = where(density > 0.0) & where(density - density == 0.0);
                const auto share = [&](double L) {
                    return choose(is_drawn, L * cos_i / density, 0.0);
                };
                const Rgb value{share(seen.red[slot]), share(seen.green[slot]),
                                share(seen.blue[slot])};
                seen.red[slot] = value.r;
                seen.green[slot] = value.g;
                seen.blue[slot] = value.b;
                cosines[slot] = luminance(value);
                fields.tfar[slot] = cosines[slot] > 0.0 ? fields.tfar[slot]
                                                        : -std::numeric_limits<float>::infinity();
            }
        });
    };
    const auto settle = [&](const ColoredVertex& v, const Lanes& points, std::size_t slot,
                            std::span<const std::uint8_t> blocked, std::span<const double> E) {
        // Without a branch: which rays are asked for and blocked nobody foresees.
        unsigned asked = 0;
        Unblocked of = *v.seen;
        for (unsigned i = 0; i < points.count;) {
            const unsigned r = points.replicate[i];
            Rgb lit = v.lit[r];
            for (; i < points.count && points.replicate[i] == r; ++i) {
                const Mask is_asked = where(E[i] > 0.0);
                const Mask is_open = is_asked & where(blocked[i] == 0);
                asked += E[i] > 0.0 ? 1 : 0;
                of.total += choose(is_asked, E[i], 0.0);
                of.open += choose(is_open, E[i], 0.0);
                const Rgb L = seen.L(slot + i);
                lit += {choose(is_open, L.r, 0.0), choose(is_open, L.g, 0.0),
                        choose(is_open, L.b, 0.0)};
            }
            v.lit[r] = lit;
        }
        *v.seen = of;
        return asked;
    };
    std::uint64_t rays = 0;
    if (light_share > 0.0) {
        rays += ask_for_all(
            source, vertices, light_pair, lanes, stream,
            [&](const ColoredVertex& /*v*/) { return by_light; }, weigh, settle);
    }
    if (light_share < 1.0) {
        rays += ask_for_all(
            source, vertices, response_pair, lanes, stream,
            [&](const ColoredVertex& v) {
                return by_cosine(CosineView(v.receiver->frame, two_sided));
            },
            [&](RayFields& fields, Brought& cosines, std::size_t slots) {
                look_up(fields, slots);
                weigh(fields, cosines, slots);
            },
            settle);
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
                unsigned asked = 0;
                for (unsigned i = 0; i < points.count;) {
                    const unsigned r = points.replicate[i];
                    double all = v.all[r], arrived = v.lit[r];
                    for (; i < points.count && points.replicate[i] == r; ++i) {
                        all += E[i];
                        arrived += choose(where(blocked[i] == 0), E[i], 0.0);
                        asked += E[i] > 0.0 ? 1 : 0;
                    }
                    v.all[r] = all;
                    v.lit[r] = arrived;
                }
                *v.rays += asked;
                return asked;
            });
    };
    const LightShape& shape = source.light.shape;
    if (const auto* rect = std::get_if<RectLight>(&shape)) {
        std::vector<Point3> places;
        places.reserve(vertices.size());
        for (const GreyVertex& v : vertices) { places.push_back(v.receiver->p); }
        std::vector<RectDirections> seen(vertices.size());
        directions(*rect, places, seen);
        std::vector<GreyVertex> usual, others;
        usual.reserve(vertices.size());
        for (std::size_t v = 0; v < vertices.size(); ++v) {
            (seen[v].whole < 0.0 ? others : usual).push_back(vertices[v]);
        }
        std::erase_if(seen, [](const RectDirections& of) { return of.whole < 0.0; });
        std::size_t next = 0;
        return gather(
                   usual, light_pair,
                   [&](const GreyVertex& /*v*/) -> const RectDirections& { return seen[next++]; }) +
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
    DomeLanes drawn;
    const auto look_up = [&](const RayFields& fields, std::size_t slots) {
        std::copy_n(fields.direction_x.begin(), slots, drawn.x);
        std::copy_n(fields.direction_y.begin(), slots, drawn.y);
        std::copy_n(fields.direction_z.begin(), slots, drawn.z);
        look(dome, slots, drawn);
    };
    const double light_share = is_even_sky(source.light.shape) ? 0.0 : 0.5;
    return gather_joined(
        source, vertices, lanes_of_ways(light_share, replicates, begin, end), light_share, stream,
        drawn.seen, DomeDirections{&dome, &drawn},
        [](const CosineView& cosine) { return CosineDirections{cosine}; }, look_up);
}

std::uint64_t gather_faces(const Source& source, const EmitterTable& faces,
                           std::span<const ColoredVertex> vertices, unsigned replicates,
                           unsigned begin, unsigned end, ShadowStream& stream)
{
    // Those that have every face below their horizon are black: nothing is drawn for them.
    std::vector<ColoredVertex> reached;
    reached.reserve(vertices.size());
    for (const ColoredVertex& v : vertices) {
        const bool is_reached = source.scene.transport.two_sided ||
                                !faces.bounds().are_below(v.receiver->p, v.receiver->frame.n);
        if (is_reached) { reached.push_back(v); }
    }
    if (reached.empty()) { return 0; }
    MeshLanes drawn;
    const double light_share = is_found_by_light_alone(source) ? 1.0 : 0.5;
    return gather_joined(
        source, reached, lanes_of_ways(light_share, replicates, begin, end), light_share, stream,
        drawn.seen, MeshDirections{&faces, &drawn},
        [&](const CosineView& cosine) {
            return MeshCosines{cosine, &faces, &drawn};
        },
        [](const RayFields& /*fields*/, std::size_t /*slots*/) {});
}

}  // namespace relight
