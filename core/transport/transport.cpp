#include "core/transport/transport.h"

#include <atomic>
#include <cmath>
#include <span>

#include "core/transport/shadow.h"

namespace relight {
namespace {

constexpr std::size_t block = 2048;  // vertices between two looks at progress

/// Fills one range of a column; returns the rays traced.
std::uint64_t fill(const Stage& stage, const Light& light, const TransportOptions& options,
                   double length_unit_m, std::size_t begin, std::span<float> E,
                   std::span<std::uint8_t> visible)
{
    const Surface& surface = *stage.surface;
    std::vector<ShadowRay> rays;
    std::vector<std::size_t> receiver;
    for (std::size_t i = 0; i < E.size(); ++i) {
        E[i] = 0.0F;
        visible[i] = 0;
        const Dir3 n = surface.normals[begin + i];
        if (!n) { continue; }
        const Point3 p = stage.mesh->positions[begin + i];
        const Arrival arrival = arrive(light.shape, p);
        const double cos_n = dot(n, arrival.wi);
        const double cos_i = options.two_sided ? std::abs(cos_n) : cos_n;
        if (!(cos_i > 0.0)) { continue; }  // behind the surface: no light, no ray
        E[i] = static_cast<float>(cos_i * per_unit_m2(arrival, length_unit_m));
        visible[i] = 1;
        if (!options.shadows || !light.cast_shadows) { continue; }
        const Clearance clear =
            stage.bvh->clearance(static_cast<double>(surface.spacing[begin + i]));
        const Vec3 step = Vec3(n) * std::copysign(clear.offset, cos_n);
        rays.push_back(shadow_ray(*stage.bvh, p, p + step, clear.from, arrival, options));
        receiver.push_back(i);
    }
    std::vector<std::uint8_t> blocked(rays.size());
    stage.bvh->occluded(rays, blocked);
    for (std::size_t r = 0; r < rays.size(); ++r) {
        if (blocked[r] == 0) { continue; }
        E[receiver[r]] = 0.0F;
        visible[receiver[r]] = 0;
    }
    return rays.size();
}

}  // namespace

Column direct_column(const Stage& stage, const Light& light, const TransportOptions& options,
                     double length_unit_m, std::size_t begin, std::size_t end)
{
    Column column{std::vector<float>(end - begin), std::vector<std::uint8_t>(end - begin), 0};
    column.rays = fill(stage, light, options, length_unit_m, begin, column.E, column.visible);
    return column;
}

Transport trace(const Stage& stage, const Scene& scene, unsigned threads, Progress& progress)
{
    const std::size_t vertices = stage.mesh->positions.size();
    Transport transport;
    progress.expect(vertices * scene.lights.size());
    for (const Light& light : scene.lights) {
        if (!light.enabled) {
            transport.columns.push_back(nullptr);
            continue;
        }
        const auto column = std::make_shared<Column>(
            Column{std::vector<float>(vertices), std::vector<std::uint8_t>(vertices), 0});
        std::atomic<std::uint64_t> rays{0};
        parallel_for(vertices, block, threads, progress, [&](std::size_t begin, std::size_t end) {
            const std::size_t count = end - begin;
            rays += fill(stage, light, scene.transport, scene.length_unit_m, begin,
                         std::span(column->E).subspan(begin, count),
                         std::span(column->visible).subspan(begin, count));
            progress.advance(count);
        });
        column->rays = rays;
        transport.rays += column->rays;
        transport.columns.push_back(column);
    }
    return transport;
}

}  // namespace relight
