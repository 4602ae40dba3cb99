#include "core/transport/column.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <span>
#include <utility>

#include "core/transport/estimate.h"
#include "core/transport/gather.h"

namespace relight {
namespace {

constexpr std::size_t most_paths = 4096;  // followed together

/// E of a light of one colour with nothing in the way, on the sides that receive. Of no direction
/// it is no number that has a meaning.
std::vector<double> closed(const Source& source, std::span<const Receiver> receivers)
{
    std::vector<Point3> places;
    std::vector<Dir3> normals;
    places.reserve(receivers.size());
    normals.reserve(receivers.size());
    for (const Receiver& receiver : receivers) {
        places.push_back(receiver.p);
        normals.push_back(receiver.frame.n);
    }
    std::vector<double> E(places.size());
    closed_irradiance(source.light.shape, places, normals, E);
    if (source.scene.transport.two_sided) {
        for (Dir3& n : normals) { n = -n; }
        std::vector<double> behind(places.size());
        closed_irradiance(source.light.shape, places, normals, behind);
        for (std::size_t i = 0; i < E.size(); ++i) { E[i] += behind[i]; }
    }
    return E;
}

/// No part of the model rises above the receiver's plane: nothing can be in its way.
bool is_open(const Source& source, const Receiver& receiver)
{
    return !source.scene.transport.two_sided &&
           source.stage.bvh->open_above(receiver.p, receiver.frame.n, receiver.clear.offset);
}

/// One vertex under one light that must be sampled, for its E. A replicate's sums stand in Sums.
struct Sampling {
    std::size_t at = 0;  ///< in the column
    std::size_t sums = 0;
    const Receiver* receiver = nullptr;
    double closed = 0.0;  ///< the direct part's E unoccluded, of a light of one colour
    bool direct = true;   ///< its direct part is drawn; else it is exact
    unsigned rays = 0;    ///< asked for that part
    Unblocked seen;       ///< of other lights
};

/// Sums over the points drawn so far: R numbers a vertex, one a replicate. Those that have no use
/// are empty.
struct Sums {
    std::vector<double> lit, all;       ///< direct, of lights of one colour: what arrived, and what
                                        ///< would have with nothing in the way
    std::vector<Rgb> colored, bounced;  ///< direct, of other lights; after a bounce or more
    unsigned replicates;

    template <class T>
    std::span<T> of(std::vector<T>& sums, const Sampling& vertex) const
    {
        return sums.empty() ? std::span<T>{}
                            : std::span(sums).subspan(vertex.sums * replicates, replicates);
    }
};

/// Draws the points [begin, end) of each replicate of the direct light of one colour for every
/// vertex. Returns rays traced.
std::uint64_t draw_grey(const Source& source, std::span<Sampling> vertices, Sums& sums,
                        unsigned begin, unsigned end, ShadowStream& stream)
{
    std::vector<GreyVertex> grey;
    grey.reserve(vertices.size());
    for (Sampling& vertex : vertices) {
        if (!vertex.direct) { continue; }
        grey.push_back(
            {vertex.receiver, sums.of(sums.lit, vertex), sums.of(sums.all, vertex), &vertex.rays});
    }
    return gather_irradiance(source, grey, lanes_of(sums.replicates, begin, end), stream);
}

/// Of other lights: skies of a map (`dome`), or shining faces.
std::uint64_t draw_colored(const Source& source, const std::optional<Dome>& dome,
                           std::span<Sampling> vertices, Sums& sums, unsigned begin, unsigned end,
                           ShadowStream& stream)
{
    std::vector<ColoredVertex> colored;
    colored.reserve(vertices.size());
    for (Sampling& vertex : vertices) {
        colored.push_back({vertex.receiver, sums.of(sums.colored, vertex), &vertex.seen});
    }
    if (dome) { return gather_dome(source, *dome, colored, sums.replicates, begin, end, stream); }
    return gather_faces(source, *std::get<MeshLight>(source.light.shape).table, colored,
                        sums.replicates, begin, end, stream);
}

/// The same points of bounces.
void draw_bounced(const Source& source, std::span<Sampling> vertices, Sums& sums, unsigned begin,
                  unsigned end, RayQueue& queue)
{
    const unsigned bounces = source.scene.transport.bounces;
    const Response cosine(source.scene.transport.two_sided);
    std::vector<Path> paths;
    for (Sampling& vertex : vertices) {
        const Receiver& receiver = *vertex.receiver;
        const Sequence sequence = source.sequence(receiver);
        const std::span<Rgb> bounced = sums.of(sums.bounced, vertex);
        for (unsigned r = 0; r < bounced.size(); ++r) {
            for (unsigned i = begin; i < end; ++i) {
                start_path(receiver, cosine, sequence.replicate(r), i, bounced[r], paths);
            }
        }
        if (paths.size() >= most_paths) {
            follow(source, std::exchange(paths, {}), bounces, queue);
        }
    }
    follow(source, std::move(paths), bounces, queue);
    queue.flush();
}

/// Writes what a vertex's samples say into the column; returns its largest standard error.
Rgb settle(const Sampling& vertex, Sums& sums, unsigned each, Column& column)
{
    const std::span<const double> lit = sums.of(sums.lit, vertex), all = sums.of(sums.all, vertex);
    const std::span<const Rgb> colored = sums.of(sums.colored, vertex);
    const std::span<const Rgb> bounced = sums.of(sums.bounced, vertex);
    const bool shares = vertex.direct && !lit.empty();
    const Estimate direct =
        shares ? estimate_share(lit, all, bounced, each, vertex.closed, vertex.rays)
               : estimate_mean(vertex.direct ? colored : std::span<const Rgb>{}, bounced, each);
    const auto write = [](std::vector<float>& values, unsigned bands, std::size_t at, Rgb value) {
        const Rgbf band = to_float(value);
        std::copy_n(band.begin(), bands, values.begin() + static_cast<std::ptrdiff_t>(at * bands));
    };
    if (vertex.direct) {
        write(column.E, column.bands, vertex.at, direct.value);
        const double share = vertex.seen.total > 0.0 ? vertex.seen.open / vertex.seen.total : 0.0;
        column.visible.share[vertex.at] =
            static_cast<float>(shares ? direct.value.r / vertex.closed : share);
    }
    if (!bounced.empty()) {
        const Rgb sum = std::accumulate(bounced.begin(), bounced.end(), Rgb{});
        write(column.E_bounced, 3, vertex.at, sum / (1.0 * sums.replicates * each));
    }
    write(column.standard_error, bounced.empty() ? column.bands : 3, vertex.at,
          direct.standard_error);
    return direct.standard_error;
}

/// The error that one light may have so that all together stay within the target.
double target_of_one_light(const Scene& scene)
{
    std::size_t sampled = 0;
    for (const Light& light : scene.lights) {
        if (light.enabled && (!is_delta(light.shape) || scene.transport.bounces > 0)) { ++sampled; }
    }
    return *scene.transport.target_standard_error / std::sqrt(static_cast<double>(sampled));
}

/// E by samples, where it must be: everything but delta lights in the open, and all bounces.
void fill_sampled(const Source& source, Vertices of, Column& column)
{
    const Stage& stage = source.stage;
    const TransportOptions& options = source.scene.transport;
    const bool delta = is_delta(source.light.shape), grey = is_grey(source.light.shape);
    std::vector<Receiver> receivers;
    receivers.reserve(of.size());
    for (std::size_t i = 0; i < of.size(); ++i) {
        receivers.push_back(vertex_receiver(stage, of[i]));
    }
    std::vector<double> exact;
    if (grey && !delta) { exact = closed(source, receivers); }
    std::vector<Sampling> vertices;
    vertices.reserve(of.size());
    for (std::size_t i = 0; i < of.size(); ++i) {
        const Receiver& receiver = receivers[i];
        if (!receiver.frame.n) { continue; }
        Sampling vertex{i, vertices.size(), &receiver, 0.0, !delta, 0, {}};
        if (grey && !delta) {
            vertex.closed = exact[i];
            const bool nothing = vertex.closed == 0.0;
            if (nothing || !source.shadowed() || is_open(source, receiver)) {
                column.E[vertex.at] = static_cast<float>(vertex.closed);
                column.visible.share[vertex.at] = nothing ? 0.0F : 1.0F;
                vertex.direct = false;
            }
        }
        if (vertex.direct || options.bounces > 0) { vertices.push_back(vertex); }
    }
    const Budget budget = budget_of(options.samples);
    const std::size_t all = vertices.size() * budget.replicates;
    Sums sums;
    sums.replicates = budget.replicates;
    if (!delta && grey) { sums.lit.resize(all), sums.all.resize(all); }
    if (!delta && !grey) { sums.colored.resize(all); }
    if (options.bounces > 0) { sums.bounced.resize(all); }
    ShadowStream stream(*stage.bvh);
    std::optional<RayQueue> queue;  // which fills what it holds: only where it is of use
    const std::optional<Dome> dome = dome_of(source.light.shape);
    if (!sums.bounced.empty()) { queue.emplace(*stage.bvh); }
    unsigned drawn = 0;
    std::span<Sampling> active(vertices);
    while (!active.empty() && drawn < budget.each) {
        const unsigned until = options.target_standard_error
                                   ? std::min(budget.each, std::max(2U, 2 * drawn))
                                   : budget.each;
        if (!sums.lit.empty()) {
            column.rays += draw_grey(source, active, sums, drawn, until, stream);
        }
        if (!sums.colored.empty()) {
            column.rays += draw_colored(source, dome, active, sums, drawn, until, stream);
        }
        if (queue) { draw_bounced(source, active, sums, drawn, until, *queue); }
        drawn = until;
        const auto unsettled = std::partition(active.begin(), active.end(), [&](const Sampling& v) {
            const Rgb error = settle(v, sums, drawn, column) * source.light.power;
            return options.target_standard_error &&
                   std::max({error.r, error.g, error.b}) > target_of_one_light(source.scene);
        });
        active = {active.begin(), unsettled};
    }
    if (queue) { column.rays += queue->traced(); }
}

}  // namespace

Column direct_and_bounced(const Source& source, Vertices vertices)
{
    const std::size_t count = vertices.size();
    const bool bounces = source.scene.transport.bounces > 0;
    const bool delta = is_delta(source.light.shape);
    Column column;
    column.bands = is_grey(source.light.shape) ? 1 : 3;
    if (!delta) {
        column.E.resize(count * column.bands);
        column.visible.share.resize(count);
    }
    if (bounces) { column.E_bounced.resize(count * 3); }
    column.standard_error.resize(count * (bounces ? 3 : column.bands));
    fill_sampled(source, vertices, column);
    return column;
}

bool needs_radiance(const Source& source)
{
    const bool told = is_delta(source.light.shape) && source.scene.transport.bounces == 0;
    return !told &&
           std::any_of(source.scene.materials.begin(), source.scene.materials.end(),
                       [&](const Material& m) { return !E_tells_radiance(source.scene, m); });
}

Column radiance_drawn(const Source& source, std::span<const std::uint32_t> materials,
                      Vertices vertices)
{
    const Stage& stage = source.stage;
    const Scene& scene = source.scene;
    constexpr unsigned apart = 1024;  // replicates of its own: E's are not drawn again
    const Budget budget = budget_of(scene.transport.samples);
    const unsigned bounces = scene.transport.bounces;
    const bool delta = is_delta(source.light.shape);
    std::vector<Rgb> sums(vertices.size());
    std::vector<Path> paths;
    RayQueue queue(*stage.bvh);
    for (std::size_t at = 0; at < vertices.size(); ++at) {
        const std::size_t v = vertices[at];
        const LocalMaterial local = vertex_material(stage, scene, materials, v);
        const Material& material = *local;
        if (E_tells_radiance(scene, material)) { continue; }
        const auto seen = seen_vertex(stage, scene, v);
        if (!seen) { continue; }
        const Response response(seen->both_sides, material, seen->wo, vertex_color(stage, v));
        const Sequence first = source.sequence(seen->receiver);
        const LightView light = view(source.light.shape, seen->receiver.p);
        Rgb& sum = sums[at];
        for (unsigned r = 0; r < budget.replicates; ++r) {
            const Sequence sequence = first.replicate(apart + r);
            if (!delta) {
                gather_direct(source, seen->receiver, light, response, sequence, 0, budget.each,
                              sum, nullptr, queue);
            }
            for (unsigned i = 0; bounces > 0 && i < budget.each; ++i) {
                start_path(seen->receiver, response, sequence, i, sum, paths);
            }
        }
        if (paths.size() >= most_paths) {
            follow(source, std::exchange(paths, {}), bounces, queue);
        }
    }
    follow(source, std::move(paths), bounces, queue);
    queue.flush();
    Column column;
    column.Lo.resize(3 * sums.size());
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const Rgbf mean = to_float(sums[i] / budget.samples());
        std::copy(mean.begin(), mean.end(), column.Lo.begin() + static_cast<std::ptrdiff_t>(3 * i));
    }
    column.rays = queue.traced();
    return column;
}

}  // namespace relight
