#include <atomic>
#include <cmath>
#include <numeric>

#include "core/transport/receiver.h"
#include "tests/bench/raw_embree.h"
#include "tests/bench/sizes.h"
#include "tests/bench/terrain.h"
#include "tests/scenes.h"

namespace relight::bench {
namespace {

constexpr std::size_t block = 4096;  // rays a thread takes at once

/// Low lights: a fifth to a quarter of the terrain faces away, as much of the rest lies in shadow.
Scene low_light(const LightShape& shape)
{
    Scene scene;
    scene.lights = {test::light_of(shape)};
    return scene;
}
const Scene& point()
{
    static const Scene scene = low_light(PointLight{{0.3, -0.2, 0.35}, {}});
    return scene;
}
const Scene& sun()
{
    static const Scene scene = low_light(DirectionalLight{normalize({1.0, 0.4, -0.35})});
    return scene;
}

const Scene& window()
{
    static const Scene scene = [] {
        Scene s = low_light(RectLight{{0.3, -0.2, 0.6}, {0, 0.4, 0}, {0.4, 0, 0}, false});
        s.transport.samples = 16;
        return s;
    }();
    return scene;
}

const Scene& sky()
{
    static const Scene scene = [] {
        Scene s = low_light(EnvironmentLight{});
        s.transport.samples = 16;
        return s;
    }();
    return scene;
}

TransportWanted wanted_by(unsigned threads)
{
    TransportWanted wanted;
    wanted.threads = threads;
    return wanted;
}

void trace_light(benchmark::State& state, const Scene& (*scene)())
{
    const Stage& stage = terrain_stage(vertices(state));
    std::uint64_t rays = 0;
    while (state.KeepRunning()) {
        Progress progress;
        rays = trace(stage, scene(), wanted_by(threads(state)), progress).rays;
    }
    rate(state, "rays", rays);
}
BENCHMARK_CAPTURE(trace_light, point, point)->Name("trace a point light")->Apply(sizes_and_threads);
BENCHMARK_CAPTURE(trace_light, sun, sun)->Name("trace a sun")->Apply(sizes_and_threads);
BENCHMARK_CAPTURE(trace_light, window, window)
    ->Name("trace a rect light, 16 samples")
    ->Apply(sizes_and_threads);
BENCHMARK_CAPTURE(trace_light, sky, sky)
    ->Name("trace a constant sky, 16 samples")
    ->Apply(sizes_and_threads);

/// The shadow rays that trace() sends for the scene's light, in the mesh's order.
std::vector<ShadowRay> shadow_rays(const Stage& stage, const Scene& scene)
{
    std::vector<ShadowRay> rays;
    for (std::size_t v = 0; v < stage.mesh->positions.size(); ++v) {
        const Point3 p = stage.mesh->positions[v];
        const Dir3 n = stage.surface->normals[v];
        const Arrival arrival = arrive(scene.lights[0].shape, p);
        if (!(dot(n, arrival.wi) > 0.0)) { continue; }
        rays.push_back(shadow_ray(*stage.bvh, vertex_receiver(stage, v), arrival.wi,
                                  arrival.distance, scene.transport));
    }
    return rays;
}

/// Why these are not the rays that trace() sends, or nullptr: as many, and as many blocked but for
/// hits so near an end that double decides them otherwise.
const char* difference(const Stage& stage, const Scene& scene, std::uint64_t rays,
                       std::uint64_t blocked)
{
    Progress progress;
    const Transport ours = trace(stage, scene, {}, progress);
    if (ours.rays != rays) { return "trace() sends another number of rays"; }
    const auto& visible = ours.columns[0]->visible;
    const double seen = std::accumulate(visible.begin(), visible.end(), 0.0);
    const double all = static_cast<double>(rays);
    const double apart = std::abs(seen + static_cast<double>(blocked) - all);
    return apart <= 1e-5 * all ? nullptr : "trace() finds another number of rays blocked";
}

template <class Blocked>
void trace_raw(benchmark::State& state, const Scene& scene, const Blocked& blocked_of)
{
    const Stage& stage = terrain_stage(vertices(state));
    const RawEmbree& raw = terrain_embree(vertices(state));
    const std::vector<RTCRay> rays = raw.rays(shadow_rays(stage, scene));
    std::atomic<std::uint64_t> blocked{0};
    while (state.KeepRunning()) {
        Progress progress;
        blocked = 0;
        parallel_for(
            rays.size(), block, threads(state), progress, [&](std::size_t begin, std::size_t end) {
                blocked += blocked_of(raw.scene(), std::span(rays).subspan(begin, end - begin));
            });
    }
    if (const char* why = difference(stage, scene, rays.size(), blocked)) {
        state.SkipWithError(why);
    }
    rate(state, "rays", rays.size());
}

void raw_one_by_one(benchmark::State& state, const Scene& (*scene)())
{
    trace_raw(state, scene(), blocked_one_by_one);
}
BENCHMARK_CAPTURE(raw_one_by_one, point, point)
    ->Name("trace a point light beside rtcOccluded1")
    ->Apply(sizes_and_threads);
BENCHMARK_CAPTURE(raw_one_by_one, sun, sun)
    ->Name("trace a sun beside rtcOccluded1")
    ->Apply(sizes_and_threads);

void raw_streams(benchmark::State& state, const Scene& (*scene)(), std::size_t length)
{
    trace_raw(state, scene(), [length](RTCScene tree, std::span<const RTCRay> rays) {
        return blocked_in_streams(tree, rays, length);
    });
}
BENCHMARK_CAPTURE(raw_streams, point_256, point, 256)
    ->Name("trace a point light beside rtcOccluded1M, 256 rays")
    ->Apply(sizes_and_threads);
BENCHMARK_CAPTURE(raw_streams, point_1024, point, 1024)
    ->Name("trace a point light beside rtcOccluded1M, 1,024 rays")
    ->Apply(sizes_and_threads);
BENCHMARK_CAPTURE(raw_streams, sun_256, sun, 256)
    ->Name("trace a sun beside rtcOccluded1M, 256 rays")
    ->Apply(sizes_and_threads);
BENCHMARK_CAPTURE(raw_streams, sun_1024, sun, 1024)
    ->Name("trace a sun beside rtcOccluded1M, 1,024 rays")
    ->Apply(sizes_and_threads);

}  // namespace
}  // namespace relight::bench
