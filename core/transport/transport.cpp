#include "core/transport/transport.h"

#include <algorithm>
#include <atomic>

#include "core/transport/column.h"

namespace relight {
namespace {

constexpr std::size_t delta_block = 2048;  // vertices between two looks at progress

/// The same where each vertex asks for many rays: some hundred thousand of them together.
std::size_t sampled_block(const Scene& scene)
{
    constexpr double rays = 1 << 18;
    const double a_vertex = scene.transport.samples * (1.0 + 2.0 * scene.transport.bounces);
    return static_cast<std::size_t>(std::clamp(rays / a_vertex, 1.0, 256.0));
}

/// Copies a block's values into the whole column's.
template <class T>
void place(std::vector<T>& whole, const std::vector<T>& part, std::size_t begin, std::size_t count)
{
    const std::size_t width = part.size() / count;
    std::copy(part.begin(), part.end(), whole.begin() + static_cast<std::ptrdiff_t>(begin * width));
}

Column block_of(const Source& source, bool radiance, std::span<const std::uint32_t> materials,
                std::size_t begin, std::size_t end)
{
    Column column = direct_and_bounced(source, begin, end);
    if (radiance && needs_radiance(source)) { add_radiance(source, materials, begin, end, column); }
    return column;
}

std::shared_ptr<const Column> whole_column(const Source& source, bool radiance,
                                           std::span<const std::uint32_t> materials,
                                           unsigned threads, Progress& progress)
{
    const std::size_t vertices = source.stage.mesh->positions.size();
    const bool bounces = source.scene.transport.bounces > 0;
    const bool sampled = bounces || !is_delta(source.light.shape);
    // An empty block says which arrays there are.
    auto whole = std::make_shared<Column>(direct_and_bounced(source, 0, 0));
    whole->E.resize(vertices * whole->bands);
    whole->visible.resize(vertices);
    if (bounces) { whole->E_bounced.resize(vertices * 3); }
    if (sampled) { whole->standard_error.resize(vertices * (bounces ? 3 : whole->bands)); }
    if (radiance && needs_radiance(source)) { whole->Lo.resize(vertices * 3); }
    std::atomic<std::uint64_t> rays{0};
    parallel_for(vertices, sampled ? sampled_block(source.scene) : delta_block, threads, progress,
                 [&](std::size_t begin, std::size_t end) {
                     const std::size_t count = end - begin;
                     const Column part = block_of(source, radiance, materials, begin, end);
                     place(whole->E, part.E, begin, count);
                     place(whole->visible, part.visible, begin, count);
                     place(whole->E_bounced, part.E_bounced, begin, count);
                     place(whole->standard_error, part.standard_error, begin, count);
                     place(whole->Lo, part.Lo, begin, count);
                     rays += part.rays;
                     progress.advance(count);
                 });
    whole->rays = rays;
    return whole;
}

void add_sky_visibility(const Stage& stage, const Scene& scene, const TransportWanted& wanted,
                        Transport& transport, Progress& progress)
{
    const std::size_t vertices = stage.mesh->positions.size();
    transport.ambient_occlusion.resize(vertices);
    if (wanted.sh) { transport.sh.resize(9 * vertices); }
    std::atomic<std::uint64_t> rays{0};
    parallel_for(vertices, sampled_block(scene), wanted.threads, progress,
                 [&](std::size_t begin, std::size_t end) {
                     const SkyVisibility sky = sky_visibility(stage, scene, wanted.sh, begin, end);
                     place(transport.ambient_occlusion, sky.ambient_occlusion, begin, end - begin);
                     place(transport.sh, sky.sh, begin, end - begin);
                     rays += sky.rays;
                     progress.advance(end - begin);
                 });
    transport.rays += rays;
}

}  // namespace

Column column(const Stage& stage, const Scene& scene, std::size_t light, bool radiance,
              std::size_t begin, std::size_t end, std::span<const std::uint32_t> materials)
{
    return block_of(Source{stage, scene, scene.lights[light], light}, radiance, materials, begin,
                    end);
}

Transport trace(const Stage& stage, const Scene& scene, const TransportWanted& wanted,
                Progress& progress)
{
    const std::size_t vertices = stage.mesh->positions.size();
    const bool sky = wanted.ambient_occlusion || wanted.sh;
    const auto materials = vertex_materials(stage, scene);
    Transport transport;
    progress.expect(vertices * (scene.lights.size() + (sky ? 1 : 0)));
    for (std::size_t l = 0; l < scene.lights.size(); ++l) {
        if (!scene.lights[l].enabled) {
            transport.columns.push_back(nullptr);
            continue;
        }
        const Source source{stage, scene, scene.lights[l], l};
        transport.columns.push_back(
            whole_column(source, wanted.radiance, materials, wanted.threads, progress));
        transport.rays += transport.columns.back()->rays;
    }
    if (sky) { add_sky_visibility(stage, scene, wanted, transport, progress); }
    return transport;
}

}  // namespace relight
