#include "core/transport/transport.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <numeric>
#include <optional>
#include <utility>

#include "core/transport/column.h"
#include "core/transport/delta_rays.h"

namespace relight {
namespace {

constexpr std::size_t delta_block = 1024;  // vertices between two looks at progress

/// The same where each vertex asks for many rays: some ten thousand of them together, which take
/// milliseconds.
std::size_t sampled_block(const Scene& scene)
{
    constexpr double rays = 1 << 14;
    const double a_vertex = scene.transport.samples * (1.0 + 2.0 * scene.transport.bounces);
    return static_cast<std::size_t>(std::clamp(rays / a_vertex, 1.0, 256.0));
}

/// The vertices [begin, end) of the file.
class Range {
  public:
    Range(const Stage& stage, std::size_t begin, std::size_t end) : ids_(end - begin)
    {
        std::iota(ids_.begin(), ids_.end(), static_cast<std::uint32_t>(begin));
        Progress never_stopped;
        fields_ = vertex_fields(*stage.mesh, *stage.surface, ids_, 1, never_stopped);
    }
    Vertices vertices() const { return {ids_, &fields_}; }

  private:
    std::vector<std::uint32_t> ids_;
    VertexFields fields_;
};

/// Copies a block's values to where its vertices stand in the whole column.
void place(std::vector<float>& whole, const std::vector<float>& part, Vertices vertices)
{
    if (part.size() == vertices.size()) {  // by far the most; a copy of n would call memmove
        for (std::size_t i = 0; i < part.size(); ++i) { whole[vertices[i]] = part[i]; }
        return;
    }
    const std::size_t width = part.size() / vertices.size();
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        std::copy_n(part.begin() + static_cast<std::ptrdiff_t>(i * width), width,
                    whole.begin() + static_cast<std::ptrdiff_t>(vertices[i] * width));
    }
}

/// Blocks of all vertices along their Morton order.
void for_blocks(const Stage& stage, std::size_t block, unsigned threads, Progress& progress,
                const std::function<void(Vertices)>& body)
{
    const Surface& surface = *stage.surface;
    const std::span<const std::uint32_t> order = surface.order;
    assert(order.size() == stage.mesh->positions.size());  // of prepare()
    parallel_for(order.size(), block, threads, progress, [&](std::size_t begin, std::size_t end) {
        body({order.subspan(begin, end - begin), &surface.ordered, begin});
    });
}

/// A column of all vertices. `make` gives that of some, with arrays of `shape`, which may hold
/// others already. Nothing when stopped.
std::optional<Column> whole_column(const Stage& stage, Column shape, std::size_t block,
                                   unsigned threads, Progress& progress,
                                   const std::function<Column(Vertices)>& make)
{
    std::atomic<std::uint64_t> rays{shape.rays};
    for_blocks(stage, block, threads, progress, [&](Vertices some) {
        const Column part = make(some);
        place(shape.E, part.E, some);
        place(shape.visible.share, part.visible.share, some);
        place(shape.E_bounced, part.E_bounced, some);
        place(shape.standard_error, part.standard_error, some);
        place(shape.Lo, part.Lo, some);
        place(shape.ambient_occlusion, part.ambient_occlusion, some);
        place(shape.sh, part.sh, some);
        rays += part.rays;
        progress.advance(some.size());
    });
    if (progress.stopped()) { return {}; }
    shape.rays = rays;
    return shape;
}

/// Visibility::bits of a delta light: it is not seen where its E is -0, which loses the sign.
std::vector<std::uint64_t> seen_bits(std::vector<float>& E, unsigned threads, Progress& progress)
{
    constexpr std::size_t word = 64, words = 1 << 12;  // no thread for what takes 50 microseconds
    std::vector<std::uint64_t> bits((E.size() + word - 1) / word);
    const std::size_t whole = E.size() / word;
    parallel_for(whole, words, threads, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t w = begin; w < end; ++w) {
            bits[w] = seen_word(std::span<float, word>(&E[word * w], word));
        }
    });
    if (whole < bits.size()) {
        std::array<float, word> last;
        last.fill(-0.0F);
        const auto first = E.begin() + static_cast<std::ptrdiff_t>(word * whole);
        std::copy(first, E.end(), last.begin());
        bits[whole] = seen_word(last);
        std::copy_n(last.begin(), E.end() - first, first);
    }
    return bits;
}

/// Does work on this thread as those of trace() would: denormals flushed, to the same bytes.
void here(const std::function<void(Progress&)>& work)
{
    Progress never_stopped;
    parallel_for(1, 1, 1, never_stopped,
                 [&](std::size_t /*begin*/, std::size_t /*end*/) { work(never_stopped); });
}

SharedColumn shared(std::optional<Column>&& column)
{
    return column ? std::make_shared<const Column>(std::move(*column)) : nullptr;
}

/// A delta light's E and visibility. Of no use when stopped.
/// @param advances the progress, by every vertex
Column delta_column(const Source& source, unsigned threads, bool advances, Progress& progress)
{
    Column column;
    column.E.resize(source.stage.mesh->positions.size());
    std::atomic<std::uint64_t> rays{0};
    for_blocks(source.stage, delta_block, threads, progress, [&](Vertices some) {
        rays += fill_delta(source, some, 0, column.E);
        if (advances) { progress.advance(some.size()); }
    });
    column.rays = rays;
    column.visible.bits = seen_bits(column.E, threads, progress);
    return column;
}

SharedColumn irradiance_column(const Source& source, unsigned threads, Progress& progress)
{
    const std::size_t vertices = source.stage.mesh->positions.size();
    const bool bounces = source.scene.transport.bounces > 0;
    Column shape;
    if (is_delta(source.light.shape)) {
        shape = delta_column(source, threads, !bounces, progress);
        if (progress.stopped()) { return nullptr; }
        if (!bounces) { return shared(std::move(shape)); }
    } else {
        shape.bands = is_grey(source.light.shape) ? 1 : 3;
        shape.E.resize(vertices * shape.bands);
        shape.visible.share.resize(vertices);
    }
    if (bounces) { shape.E_bounced.resize(vertices * 3); }
    shape.standard_error.resize(vertices * (bounces ? 3 : shape.bands));
    return shared(whole_column(source.stage, std::move(shape), sampled_block(source.scene), threads,
                               progress,
                               [&](Vertices some) { return direct_and_bounced(source, some); }));
}

SharedColumn radiance_column(const Source& source, unsigned threads, Progress& progress)
{
    Column shape;
    shape.Lo.resize(source.stage.mesh->positions.size() * 3);
    const auto materials = vertex_materials(source.stage, source.scene);
    return shared(
        whole_column(source.stage, std::move(shape), sampled_block(source.scene), threads, progress,
                     [&](Vertices some) { return radiance_drawn(source, materials, some); }));
}

SharedColumn sky_column(const Stage& stage, const Scene& scene, bool sh, unsigned threads,
                        Progress& progress)
{
    Column shape;
    shape.ambient_occlusion.resize(stage.mesh->positions.size());
    if (sh) { shape.sh.resize(9 * stage.mesh->positions.size()); }
    return shared(
        whole_column(stage, std::move(shape), sampled_block(scene), threads, progress,
                     [&](Vertices some) { return sky_visibility(stage, scene, sh, some); }));
}

}  // namespace

Column column(const Stage& stage, const Scene& scene, std::size_t light, std::size_t begin,
              std::size_t end)
{
    const Source source{stage, scene, scene.lights[light], light};
    const bool delta = is_delta(source.light.shape);
    const Range range(stage, begin, end);
    Column some;
    here([&](Progress& never_stopped) {
        if (!delta || scene.transport.bounces > 0) {
            some = direct_and_bounced(source, range.vertices());
        }
        if (!delta) { return; }
        some.E.resize(end - begin);
        some.rays += fill_delta(source, range.vertices(), begin, some.E);
        some.visible.bits = seen_bits(some.E, 1, never_stopped);
    });
    return some;
}

Column drawn_radiance(const Stage& stage, const Scene& scene, std::size_t light, std::size_t begin,
                      std::size_t end, std::span<const std::uint32_t> materials)
{
    const Source source{stage, scene, scene.lights[light], light};
    if (!needs_radiance(source)) { return {}; }
    const Range range(stage, begin, end);
    Column some;
    here([&](Progress& /*never_stopped*/) {
        some = radiance_drawn(source, materials, range.vertices());
    });
    return some;
}

Transport trace(const Stage& stage, const Scene& scene, const TransportWanted& wanted,
                Progress& progress)
{
    Transport transport;
    struct Wish {
        Told told;
        std::size_t light;
        SharedColumn* where;
        std::function<SharedColumn()> make;
    };
    std::vector<Wish> wishes;
    transport.columns.resize(scene.lights.size());
    transport.drawn.resize(scene.lights.size());
    for (std::size_t l = 0; l < scene.lights.size(); ++l) {
        const Source source{stage, scene, scene.lights[l], l};
        if (!source.light.enabled) { continue; }
        wishes.push_back({Told::E, l, &transport.columns[l], [&, source] {
                              return irradiance_column(source, wanted.threads, progress);
                          }});
        if (!wanted.radiance || !needs_radiance(source)) { continue; }
        wishes.push_back({Told::Lo, l, &transport.drawn[l], [&, source] {
                              return radiance_column(source, wanted.threads, progress);
                          }});
    }
    if (wanted.ambient_occlusion || wanted.sh) {
        wishes.push_back({Told::Sky, 0, &transport.sky, [&] {
                              return sky_column(stage, scene, wanted.sh, wanted.threads, progress);
                          }});
    }
    const std::size_t vertices = stage.mesh->positions.size();
    progress.expect(vertices * wishes.size());
    for (const Wish& wish : wishes) {
        if (progress.stopped()) { break; }
        bool made = false;
        const auto make_now = [&] {
            made = true;
            SharedColumn column = wish.make();
            if (column != nullptr) { transport.rays += column->rays; }
            return column;
        };
        *wish.where = wanted.keep ? wanted.keep(wish.told, wish.light, make_now) : make_now();
        if (!made) { progress.advance(vertices); }
    }
    return transport;
}

}  // namespace relight
