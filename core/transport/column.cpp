#include "core/transport/column.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "core/transport/estimate.h"
#include "core/transport/gather.h"

namespace relight {
namespace {

constexpr std::size_t most_paths = 4096;  // followed together

/// Direct light of a delta light: one ray a vertex that faces it.
void fill_delta(const Source& source, std::size_t begin, std::size_t end, Column& column)
{
    const Stage& stage = source.stage;
    const TransportOptions& options = source.scene.transport;
    std::vector<ShadowRay> rays;
    std::vector<std::size_t> asking;
    for (std::size_t v = begin; v < end; ++v) {
        const Dir3 n = stage.surface->normals[v];
        if (!n) { continue; }
        const Arrival arrival = arrive(source.light.shape, stage.mesh->positions[v]);
        const double cos_n = dot(n, arrival.wi);
        const double cos_i = options.two_sided ? std::abs(cos_n) : cos_n;
        if (!(cos_i > 0.0)) { continue; }  // behind the surface: no light, no ray
        const std::size_t i = v - begin;
        column.E[i] = static_cast<float>(cos_i * per_unit_m2(arrival, source.scene.length_unit_m));
        column.visible[i] = 1.0F;
        if (!source.shadowed()) { continue; }
        rays.push_back(shadow_ray(*stage.bvh, vertex_receiver(stage, v), arrival.wi,
                                  arrival.distance, options));
        asking.push_back(i);
    }
    std::vector<std::uint8_t> blocked(rays.size());
    stage.bvh->occluded(rays, blocked);
    for (std::size_t r = 0; r < rays.size(); ++r) {
        if (blocked[r] == 0) { continue; }
        column.E[asking[r]] = 0.0F;
        column.visible[asking[r]] = 0.0F;
    }
    column.rays += rays.size();
}

/// E with nothing in the way, on the sides that receive; nothing: no closed form is known.
std::optional<double> closed(const Source& source, const Receiver& receiver)
{
    const auto& shape = source.light.shape;
    auto E = closed_irradiance(shape, receiver.p, receiver.frame.n);
    if (E && source.scene.transport.two_sided) {
        *E += closed_irradiance(shape, receiver.p, -receiver.frame.n).value_or(0.0);
    }
    return E;
}

/// No part of the model rises above the receiver's plane: nothing can be in its way.
bool is_open(const Source& source, const Receiver& receiver)
{
    return !source.scene.transport.two_sided &&
           source.stage.bvh->open_above(receiver.p, receiver.frame.n, receiver.clear.offset);
}

/// One vertex under one light that must be sampled, for its E.
struct Sampling {
    std::size_t at = 0;  ///< in the column
    Receiver receiver;
    std::optional<double> closed;  ///< the direct part's, if known
    bool direct = true;            ///< its direct part is drawn; else it is exact
    Tally tally;
};

/// Draws the points [begin, end) of each replicate for every vertex.
void draw(const Source& source, std::span<Sampling> vertices, Budget budget, unsigned begin,
          unsigned end, RayQueue& queue)
{
    const unsigned bounces = source.scene.transport.bounces;
    const Response cosine(source.scene.transport.two_sided);
    std::vector<Path> paths;
    for (Sampling& vertex : vertices) {
        for (unsigned r = 0; r < budget.replicates; ++r) {
            const Sequence sequence = source.sequence(vertex.receiver, r);
            if (vertex.direct) {
                gather_direct(source, vertex.receiver, cosine, sequence, begin, end,
                              vertex.closed.has_value(), vertex.tally.lit[r],
                              vertex.closed ? &vertex.tally.all[r] : nullptr, &vertex.tally, queue);
            }
            for (unsigned i = begin; bounces > 0 && i < end; ++i) {
                start_path(vertex.receiver, cosine, sequence, i, vertex.tally.bounced[r], paths);
            }
        }
        if (paths.size() >= most_paths) {
            follow(source, std::exchange(paths, {}), bounces, queue);
        }
        if (queue.full()) { queue.flush(); }
    }
    follow(source, std::move(paths), bounces, queue);
    queue.flush();
}

/// Writes what a vertex's samples say into the column; returns its largest standard error.
Rgb settle(const Sampling& vertex, Budget budget, unsigned each, Column& column)
{
    const Tally& tally = vertex.tally;
    const Estimate direct = estimate(tally, budget.replicates, each, vertex.closed);
    const auto write = [](std::vector<float>& values, unsigned bands, std::size_t at, Rgb value) {
        const Rgbf band = to_float(value);
        std::copy_n(band.begin(), bands, values.begin() + static_cast<std::ptrdiff_t>(at * bands));
    };
    if (vertex.direct) {
        write(column.E, column.bands, vertex.at, direct.value);
        column.visible[vertex.at] =
            static_cast<float>(tally.total > 0.0 ? tally.open / tally.total : 0.0);
    }
    const bool bounces = !column.E_bounced.empty();
    if (bounces) {
        Rgb bounced;
        for (unsigned r = 0; r < budget.replicates; ++r) { bounced += tally.bounced[r]; }
        write(column.E_bounced, 3, vertex.at, bounced / (1.0 * budget.replicates * each));
    }
    write(column.standard_error, bounces ? 3 : column.bands, vertex.at, direct.standard_error);
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
void fill_sampled(const Source& source, std::size_t begin, std::size_t end, Column& column)
{
    const Stage& stage = source.stage;
    const TransportOptions& options = source.scene.transport;
    const bool delta = is_delta(source.light.shape);
    std::vector<Sampling> vertices;
    for (std::size_t v = begin; v < end; ++v) {
        const Receiver receiver = vertex_receiver(stage, v);
        if (!receiver.frame.n) { continue; }
        Sampling vertex{v - begin, receiver, {}, !delta, {}};
        if (!delta) { vertex.closed = closed(source, receiver); }
        const bool nothing = vertex.closed && *vertex.closed == 0.0;
        if (vertex.closed && (nothing || !source.shadowed() || is_open(source, receiver))) {
            for (unsigned b = 0; b < column.bands; ++b) {
                column.E[vertex.at * column.bands + b] = static_cast<float>(*vertex.closed);
            }
            column.visible[vertex.at] = nothing ? 0.0F : 1.0F;
            vertex.direct = false;
            vertex.closed = 0.0;
        }
        if (vertex.direct || options.bounces > 0) { vertices.push_back(vertex); }
    }
    const Budget budget = budget_of(options.samples);
    RayQueue queue(*stage.bvh);
    unsigned drawn = 0;
    std::span<Sampling> active(vertices);
    while (!active.empty() && drawn < budget.each) {
        const unsigned until = options.target_standard_error
                                   ? std::min(budget.each, std::max(2U, 2 * drawn))
                                   : budget.each;
        draw(source, active, budget, drawn, until, queue);
        drawn = until;
        const auto unsettled = std::partition(active.begin(), active.end(), [&](const Sampling& v) {
            const Rgb error = settle(v, budget, drawn, column) * source.light.power;
            return options.target_standard_error &&
                   std::max({error.r, error.g, error.b}) > target_of_one_light(source.scene);
        });
        active = {active.begin(), unsettled};
    }
    column.rays += queue.traced();
}

}  // namespace

Column direct_and_bounced(const Source& source, std::size_t begin, std::size_t end)
{
    const std::size_t count = end - begin;
    const bool bounces = source.scene.transport.bounces > 0;
    const bool delta = is_delta(source.light.shape);
    Column column;
    column.bands = is_grey(source.light.shape) ? 1 : 3;
    column.E.resize(count * column.bands);
    column.visible.resize(count);
    if (bounces) { column.E_bounced.resize(count * 3); }
    if (bounces || !delta) { column.standard_error.resize(count * (bounces ? 3 : column.bands)); }
    if (delta) { fill_delta(source, begin, end, column); }
    if (bounces || !delta) { fill_sampled(source, begin, end, column); }
    return column;
}

bool needs_radiance(const Source& source)
{
    const bool told = is_delta(source.light.shape) && source.scene.transport.bounces == 0;
    return !told &&
           std::any_of(source.scene.materials.begin(), source.scene.materials.end(),
                       [&](const Material& m) { return !E_tells_radiance(source.scene, m); });
}

void add_radiance(const Source& source, std::span<const std::uint32_t> materials, std::size_t begin,
                  std::size_t end, Column& column)
{
    const Stage& stage = source.stage;
    const Scene& scene = source.scene;
    constexpr unsigned apart = 1024;  // replicates of its own: E's are not drawn again
    const Budget budget = budget_of(scene.transport.samples);
    const unsigned bounces = scene.transport.bounces;
    const bool delta = is_delta(source.light.shape);
    std::vector<Rgb> sums(end - begin);
    std::vector<Path> paths;
    RayQueue queue(*stage.bvh);
    for (std::size_t v = begin; v < end; ++v) {
        const LocalMaterial local = vertex_material(stage, scene, materials, v);
        const Material& material = *local;
        if (E_tells_radiance(scene, material)) { continue; }
        const auto seen = seen_vertex(stage, scene, v);
        if (!seen) { continue; }
        const Response response(seen->both_sides, material, seen->wo, vertex_color(stage, v));
        Rgb& sum = sums[v - begin];
        for (unsigned r = 0; r < budget.replicates; ++r) {
            const Sequence sequence = source.sequence(seen->receiver, apart + r);
            if (!delta) {
                gather_direct(source, seen->receiver, response, sequence, 0, budget.each, false,
                              sum, nullptr, nullptr, queue);
            }
            for (unsigned i = 0; bounces > 0 && i < budget.each; ++i) {
                start_path(seen->receiver, response, sequence, i, sum, paths);
            }
        }
        if (queue.full()) { queue.flush(); }
        if (paths.size() >= most_paths) {
            follow(source, std::exchange(paths, {}), bounces, queue);
        }
    }
    follow(source, std::move(paths), bounces, queue);
    queue.flush();
    column.Lo.resize(3 * sums.size());
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const Rgbf mean = to_float(sums[i] / budget.samples());
        std::copy(mean.begin(), mean.end(), column.Lo.begin() + static_cast<std::ptrdiff_t>(3 * i));
    }
    column.rays += queue.traced();
}

}  // namespace relight
