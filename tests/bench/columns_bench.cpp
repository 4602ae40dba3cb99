#include <cmath>
#include <cstring>
#include <map>
#include <string>
#include <utility>

#include "core/display/display.h"
#include "core/shade/shade.h"
#include "tests/bench/sizes.h"
#include "tests/bench/terrain.h"
#include "tests/scenes.h"

namespace relight::bench {
namespace {

/// A new power over columns that are there already: no ray, a dot product a vertex.
enum class Answer {
    E,      ///< irradiance alone, 3 floats
    Color,  ///< Lambert's radiance, displayed: 3 bytes
};

/// A ring of lights over the terrain.
Scene ring(std::size_t lights)
{
    constexpr double radius = 1.4, height = 4.0;
    Scene scene;
    for (std::size_t l = 0; l < lights; ++l) {
        const double angle = 2.4 * static_cast<double>(l);
        scene.lights.push_back(test::light_of(
            PointLight{{radius * std::cos(angle), radius * std::sin(angle), height}, {}},
            {8.0, 7.0, 6.0}));
    }
    return scene;
}

const Transport& columns(std::size_t vertices, std::size_t lights)
{
    static std::map<std::pair<std::size_t, std::size_t>, Transport> kept;
    const auto [at, is_new] = kept.try_emplace({vertices, lights});
    if (is_new) {
        Progress progress;
        at->second = trace(terrain_stage(vertices), ring(lights), {}, progress);
    }
    return at->second;
}

void relight(benchmark::State& state, Answer answer, std::size_t lights)
{
    const Stage& stage = terrain_stage(vertices(state));
    const Transport& transport = columns(vertices(state), lights);
    Scene scene = ring(lights);
    ShadeOptions options;
    options.radiance = answer == Answer::Color;
    options.threads = threads(state);
    Progress progress;
    Shaded shaded;
    while (state.KeepRunning()) {
        scene.lights[0].power = scene.lights[0].power * 1.0001;
        shaded = shade(stage, transport, scene, options, progress);
        benchmark::DoNotOptimize(shaded.irradiance.data());
        if (answer == Answer::E) { continue; }
        const auto color = to_srgb8(shaded.radiance, {}, threads(state), progress);
        benchmark::DoNotOptimize(color.data());
    }
    rate(state, "vertex_lights", stage.mesh->positions.size() * lights);
}

/// What such a pass cannot but read (a float a light) and write: a memcpy of half of it reads and
/// writes as many bytes, to memory that is there already.
void move_bytes(benchmark::State& state, Answer answer, std::size_t lights)
{
    constexpr std::size_t block = 1 << 16;
    const std::size_t written = answer == Answer::E ? sizeof(Rgbf) : sizeof(Rgb8);
    const std::size_t bytes = vertices(state) * (lights * sizeof(float) + written) / 2;
    const std::vector<char> from(bytes, 'x');
    std::vector<char> to(bytes);
    while (state.KeepRunning()) {
        Progress progress;
        parallel_for(bytes, block, threads(state), progress,
                     [&](std::size_t begin, std::size_t end) {
                         std::memcpy(to.data() + begin, from.data() + begin, end - begin);
                     });
        benchmark::ClobberMemory();
    }
    rate(state, "vertex_lights", vertices(state) * lights);
}

[[maybe_unused]] const bool registered = [] {
    for (const Answer answer : {Answer::E, Answer::Color}) {
        for (const std::size_t lights : {1U, 4U, 16U}) {
            const std::string name = std::string("another power, ") +
                                     (answer == Answer::E ? "E of " : "colour of ") +
                                     std::to_string(lights) + (lights == 1 ? " light" : " lights");
            benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
                relight(state, answer, lights);
            })->Apply(sizes_and_threads);
            benchmark::RegisterBenchmark(
                (name + " beside memcpy of its bytes").c_str(),
                [=](benchmark::State& state) { move_bytes(state, answer, lights); })
                ->Apply(sizes_and_threads);
        }
    }
    return true;
}();

}  // namespace
}  // namespace relight::bench
