#include <cstring>

#include "core/shade/shade.h"
#include "tests/bench/sizes.h"
#include "tests/bench/terrain.h"
#include "tests/scenes.h"

namespace relight::bench {
namespace {

/// Four lights high over the terrain, seen by a camera: nearly every vertex is lit by each.
Scene four_lights(const Material& material)
{
    Scene scene;
    for (const Point3 place : {Point3{1, 1, 4}, {-1, 1, 4}, {-1, -1, 4}, {1, -1, 4}}) {
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
    const Scene scene = four_lights(material);
    ShadeOptions options;
    options.threads = threads(state);
    Progress progress;
    const Transport transport = trace(stage, scene, {}, progress);
    while (state.KeepRunning()) {
        const Shaded shaded = shade(stage, transport, scene, options, progress);
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

/// Half of what shade() cannot but read (four columns, place, normal) and write (E and L).
void move_bytes(benchmark::State& state)
{
    constexpr std::size_t block = 1 << 16;
    constexpr std::size_t bytes =
        (4 * sizeof(float) + sizeof(Point3) + sizeof(Dir3) + 2 * sizeof(Rgbf)) / 2;
    const std::vector<char> from(vertices(state) * bytes, 'x');
    std::vector<char> to(from.size());
    while (state.KeepRunning()) {
        Progress progress;
        parallel_for(from.size(), block, threads(state), progress,
                     [&](std::size_t begin, std::size_t end) {
                         std::memcpy(to.data() + begin, from.data() + begin, end - begin);
                     });
        benchmark::ClobberMemory();
    }
    rate(state, "vertex_lights", vertices(state) * 4);
}
BENCHMARK(move_bytes)
    ->Name("shade 4 lights, Lambert beside memcpy of its bytes")
    ->Apply(sizes_and_threads);
BENCHMARK(move_bytes)
    ->Name("shade 4 lights, Cook-Torrance GGX beside memcpy of its bytes")
    ->Apply(sizes_and_threads);

}  // namespace
}  // namespace relight::bench
