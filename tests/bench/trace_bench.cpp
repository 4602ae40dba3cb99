#include <atomic>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "core/transport/transport.h"
#include "tests/bench/sent_rays.h"
#include "tests/bench/sizes.h"
#include "tests/bench/terrain.h"
#include "tests/scenes.h"

namespace relight::bench {
namespace {

constexpr std::size_t block = 4096;  // rays a thread takes at once

/// What is lit: the terrain as triangles, or as discs.
struct Ground {
    const char* suffix;
    const Stage& (*stage)(std::size_t vertices);
    RawEmbree& (*raw)(std::size_t vertices);
    bool faces_y = false;
};
constexpr Ground grounds[] = {{"", terrain_stage, terrain_embree},
                              {" on discs", cloud_stage, cloud_embree}};
constexpr Ground outdoors{"", outdoor_stage, outdoor_embree, true};

struct Lit {
    const char* name;
    Scene scene;
    void (*sizes)(benchmark::internal::Benchmark*);
};

/// Low lights: a fifth to a quarter of the terrain faces away, as much of the rest lies in shadow.
const std::vector<Lit>& lit()
{
    static const std::vector<Lit> all = [] {
        constexpr unsigned samples = 16;
        const auto scene = [](const LightShape& shape) {
            Scene s;
            s.lights = {test::light_of(shape)};
            s.transport.samples = samples;  // of the rect and the sky
            return s;
        };
        return std::vector<Lit>{
            {"a point light", scene(PointLight{{0.3, -0.2, 0.35}, {}}), sizes_and_threads},
            {"a sun", scene(DirectionalLight{normalize({1.0, 0.4, -0.35})}), sizes_and_threads},
            {"a rect light, 16 samples",
             scene(RectLight{{0.3, -0.2, 0.6}, {0, 0.4, 0}, {0.4, 0, 0}, false}),
             few_sizes_and_threads},
            {"a constant sky, 16 samples", scene(EnvironmentLight{}), few_sizes_and_threads}};
    }();
    return all;
}

/// Low hills of light around, and a lamp on them: 1,024 by 512 texels, none of them even.
EnvironmentLight hdr_map()
{
    Image image{1024, 512, {}, {}};
    image.pixels.reserve(image.at(0, image.height));
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const float across = static_cast<float>(x) / 1024.0F;
            const float down = static_cast<float>(y) / 512.0F;
            const float waves = 1.0F + std::sin(200.0F * across) * std::sin(90.0F * down);
            const float away = std::hypot(across - 0.3F, down - 0.3F);
            const float lamp = away < 0.03F ? 300.0F : 0.0F;
            image.pixels.push_back({waves + lamp, waves + 0.8F * lamp, 2.0F * waves + 0.5F * lamp});
        }
    }
    return {std::make_shared<const EnvironmentMap>(std::move(image)), 0.5};
}

MeshLight shining_lamp()
{
    const Stage& stage = outdoor_stage(1'000);  // the same at every size
    std::vector<Emitter> emitters;
    for (std::uint32_t t = 0; t < lamp_triangles; ++t) {
        const Triangle& corners = stage.surface->triangles[t];
        const auto& p = stage.mesh->positions;
        emitters.push_back({{p[corners[0]], p[corners[1]], p[corners[2]]}, t, Rgb::grey(1.0)});
    }
    return {std::make_shared<const EmitterTable>(std::move(emitters))};
}

/// Lights that are drawn in part by the cosine, over the terrain lying.
const std::vector<Lit>& lit_outdoors()
{
    static const std::vector<Lit> all = [] {
        const auto scene = [](const LightShape& shape) {
            Scene s;
            s.lights = {test::light_of(shape)};
            s.transport.samples = 16;
            return s;
        };
        return std::vector<Lit>{
            {"an HDR map, 16 samples", scene(hdr_map()), few_sizes_and_threads},
            {"a clear sky, 16 samples", scene(make_sky(normalize({0.6, 0.5, 0.3}), 3.0)),
             few_sizes_and_threads},
            {"an emissive mesh, 16 samples", scene(shining_lamp()), few_sizes_and_threads}};
    }();
    return all;
}

/// A yardstick: Embree alone, over the rays that trace() sends.
struct Pattern {
    const char* name;
    bool by_morton;
    std::uint64_t (*blocked)(RTCScene, std::span<const RawRay>);
};
constexpr Pattern patterns[] = {
    {"rtcOccluded1, mesh order", false, blocked_one_by_one},
    {"rtcOccluded1M, 256 rays, Morton order", true,
     [](RTCScene tree, std::span<const RawRay> rays) {
         return blocked_in_streams(tree, rays, 256);
     }},
    {"rtcOccluded1M, 1,024 rays, Morton order", true,
     [](RTCScene tree, std::span<const RawRay> rays) {
         return blocked_in_streams(tree, rays, 1024);
     }},
    {"rtcOccludedNp, 256 rays, Morton order", true,
     [](RTCScene tree, std::span<const RawRay> rays) { return blocked_by_field(tree, rays, 256); }},
};

void trace_ours(benchmark::State& state, const Ground& ground, const Scene& scene)
{
    const Stage& stage = ground.stage(vertices(state));
    TransportWanted wanted;
    wanted.threads = threads(state);
    std::uint64_t rays = 0;
    while (state.KeepRunning()) {
        Progress progress;
        rays = trace(stage, scene, wanted, progress).rays;
    }
    rate(state, "rays", rays);
}

/// Made once and kept: a million vertices' 16 samples are a gigabyte.
const SentRays& sent(const Ground& ground, const Scene& scene, std::size_t vertices)
{
    static std::map<std::pair<const Scene*, const Stage*>, SentRays> kept;
    const Stage& stage = ground.stage(vertices);
    const auto [at, is_new] = kept.try_emplace({&scene, &stage});
    if (is_new) {
        at->second = sent_rays(stage, ground.raw(vertices), scene,
                               terrain_stage(vertices).mesh->positions.size(), ground.faces_y);
    }
    return at->second;
}

/// Why these are not the rays of trace(), or nullptr: as many, and as many blocked but for hits so
/// near an end that double decides them otherwise.
const char* difference(const SentRays& sent, std::uint64_t blocked)
{
    const auto rays = static_cast<double>(sent.by_mesh.size());
    if (sent.told != sent.by_mesh.size()) {
        return "trace() sends rays by a call that sent_rays.cpp does not hear";
    }
    const double apart = std::abs(static_cast<double>(sent.blocked) - static_cast<double>(blocked));
    return apart <= 1e-4 * rays ? nullptr : "trace() finds another number of rays blocked";
}

void trace_raw(benchmark::State& state, const Ground& ground, const Scene& scene,
               const Pattern& pattern)
{
    const SentRays& all = sent(ground, scene, vertices(state));
    const auto& rays = pattern.by_morton ? all.by_morton : all.by_mesh;
    RTCScene tree = ground.raw(vertices(state)).scene();
    std::atomic<std::uint64_t> blocked{0};
    while (state.KeepRunning()) {
        Progress progress;
        blocked = 0;
        parallel_for(
            rays.size(), block, threads(state), progress, [&](std::size_t begin, std::size_t end) {
                blocked += pattern.blocked(tree, std::span(rays).subspan(begin, end - begin));
            });
    }
    if (const char* why = difference(all, blocked)) { state.SkipWithError(why); }
    rate(state, "rays", rays.size());
}

void register_all(const Ground& ground, const std::vector<Lit>& lights)
{
    for (const Lit& one : lights) {
        const std::string name = std::string("trace ") + one.name + ground.suffix;
        benchmark::RegisterBenchmark(name.c_str(), [&](benchmark::State& state) {
            trace_ours(state, ground, one.scene);
        })->Apply(one.sizes);
        for (const Pattern& pattern : patterns) {
            benchmark::RegisterBenchmark(
                (name + " beside " + pattern.name).c_str(),
                [&](benchmark::State& state) { trace_raw(state, ground, one.scene, pattern); })
                ->Apply(one.sizes);
        }
    }
}

[[maybe_unused]] const bool registered = [] {
    for (const Ground& ground : grounds) { register_all(ground, lit()); }
    register_all(outdoors, lit_outdoors());
    return true;
}();

}  // namespace
}  // namespace relight::bench
