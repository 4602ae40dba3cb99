#include <cmath>
#include <cstring>
#include <numbers>

#include "core/shade/shade.h"
#include "tests/bench/sizes.h"
#include "tests/bench/terrain.h"
#include "tests/scenes.h"

namespace relight::bench {
namespace {

/// Lights high over the terrain, seen by a camera: nearly every vertex is lit by each.
Scene lights_above(std::size_t lights, const Material& material)
{
    Scene scene;
    for (std::size_t l = 0; l < lights; ++l) {
        const double angle = 0.25 * std::numbers::pi * (1.0 + 2.0 * static_cast<double>(l));
        const Point3 place{std::cos(angle), std::sin(angle), 4.0};
        scene.lights.push_back(test::light_of(PointLight{place, {}}, {30.0, 28.0, 25.0}));
    }
    scene.materials = {material};
    scene.view = CameraView{};
    scene.camera.eye = {0.5, -1.0, 5.0};
    return scene;
}

void shade_lights(benchmark::State& state, const Material& material)
{
    const Stage& stage = terrain_stage(vertices(state));
    const Scene scene = lights_above(4, material);
    ShadeOptions options;
    options.threads = threads(state);
    Progress progress;
    const Transport transport = trace(stage, scene, {}, progress);
    Shaded shaded;
    while (state.KeepRunning()) {
        shaded = shade(stage, transport, scene, options, progress);
        benchmark::DoNotOptimize(shaded.radiance.data());
    }
    rate(state, "vertex_lights", stage.mesh->positions.size() * scene.lights.size());
}
BENCHMARK_CAPTURE(shade_lights, lambert, Lambert{})
    ->Name("shade 4 lights, Lambert")
    ->Apply(sizes_and_threads);
BENCHMARK_CAPTURE(shade_lights, ggx, make_cook_torrance({}))
    ->Name("shade 4 lights, Cook-Torrance GGX")
    ->Apply(sizes_and_threads);

BENCHMARK_CAPTURE(shade_lights, principled, Principled{})
    ->Name("shade 4 lights, principled")
    ->Apply(sizes_and_threads);

/// E alone: what a change of power costs.
void E_from_columns(benchmark::State& state, std::size_t lights)
{
    const Stage& stage = terrain_stage(vertices(state));
    const Scene scene = lights_above(lights, Lambert{});
    ShadeOptions options;
    options.radiance = false;
    options.threads = threads(state);
    Progress progress;
    const Transport transport = trace(stage, scene, {}, progress);
    Shaded shaded;
    while (state.KeepRunning()) {
        shaded = shade(stage, transport, scene, options, progress);
        benchmark::DoNotOptimize(shaded.irradiance.data());
    }
    rate(state, "vertex_lights", stage.mesh->positions.size() * lights);
}
BENCHMARK_CAPTURE(E_from_columns, one, 1)->Name("E from 1 column")->Apply(sizes_and_threads);
BENCHMARK_CAPTURE(E_from_columns, four, 4)->Name("E from 4 columns")->Apply(sizes_and_threads);
BENCHMARK_CAPTURE(E_from_columns, sixteen, 16)->Name("E from 16 columns")->Apply(sizes_and_threads);

/// memcpy of half of the bytes a vertex that must be read and written.
void move_bytes(benchmark::State& state, std::size_t bytes, std::size_t lights)
{
    constexpr std::size_t block = 1 << 16;
    const std::vector<char> from(vertices(state) * bytes / 2, 'x');
    std::vector<char> to(from.size());
    while (state.KeepRunning()) {
        Progress progress;
        parallel_for(from.size(), block, threads(state), progress,
                     [&](std::size_t begin, std::size_t end) {
                         std::memcpy(to.data() + begin, from.data() + begin, end - begin);
                     });
        benchmark::ClobberMemory();
    }
    rate(state, "vertex_lights", vertices(state) * lights);
}
// Four columns, place, normal; E and L.
constexpr std::size_t shade_bytes =
    4 * sizeof(float) + sizeof(Point3) + sizeof(Dir3) + 2 * sizeof(Rgbf);
BENCHMARK_CAPTURE(move_bytes, lambert, shade_bytes, 4)
    ->Name("shade 4 lights, Lambert beside memcpy of its bytes")
    ->Apply(sizes_and_threads);
BENCHMARK_CAPTURE(move_bytes, ggx, shade_bytes, 4)
    ->Name("shade 4 lights, Cook-Torrance GGX beside memcpy of its bytes")
    ->Apply(sizes_and_threads);
BENCHMARK_CAPTURE(move_bytes, principled, shade_bytes, 4)
    ->Name("shade 4 lights, principled beside memcpy of its bytes")
    ->Apply(sizes_and_threads);
BENCHMARK_CAPTURE(move_bytes, one, sizeof(float) + sizeof(Rgbf), 1)
    ->Name("E from 1 column beside memcpy of its bytes")
    ->Apply(sizes_and_threads);
BENCHMARK_CAPTURE(move_bytes, four, 4 * sizeof(float) + sizeof(Rgbf), 4)
    ->Name("E from 4 columns beside memcpy of its bytes")
    ->Apply(sizes_and_threads);
BENCHMARK_CAPTURE(move_bytes, sixteen, 16 * sizeof(float) + sizeof(Rgbf), 16)
    ->Name("E from 16 columns beside memcpy of its bytes")
    ->Apply(sizes_and_threads);

}  // namespace
}  // namespace relight::bench
