#include <valgrind/callgrind.h>

#include <cstdio>
#include <functional>
#include <string>
#include <variant>

#include "core/display/display.h"
#include "core/io/readers.h"
#include "core/io/writers.h"
#include "core/shade/shade.h"
#include "tests/bench/terrain.h"
#include "tests/scenes.h"
#include "tests/written.h"

// Runs each hot kernel once, on one thread, for callgrind to count (tests/bench/instructions).
// Prints a line a kernel: name, tab, how many units it did, tab, what a unit is.

namespace relight::bench {
namespace {

constexpr std::size_t vertices = 10'000;

/// The first run makes tables and grows the heap; the second counts, and is dumped by name.
void count(const char* name, const char* unit, const std::function<std::uint64_t()>& kernel)
{
    kernel();
    CALLGRIND_START_INSTRUMENTATION;
    CALLGRIND_ZERO_STATS;
    const std::uint64_t units = kernel();
    CALLGRIND_DUMP_STATS_AT(name);
    CALLGRIND_STOP_INSTRUMENTATION;
    std::printf("%s\t%llu\t%s\n", name, static_cast<unsigned long long>(units), unit);
}

Scene lit_by(const LightShape& shape)
{
    Scene scene;
    scene.lights = {test::light_of(shape)};
    scene.transport.samples = 16;
    return scene;
}

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

void count_geometry()
{
    const Mesh mesh = terrain(vertices);
    count("prepare", "vertex", [&] {
        Progress progress;
        return prepare(mesh, 1, progress).normals.size();
    });
}

void count_trace()
{
    const auto rays = [](const Scene& scene) {
        return [scene] {
            Progress progress;
            TransportWanted wanted;
            wanted.threads = 1;
            return trace(terrain_stage(vertices), scene, wanted, progress).rays;
        };
    };
    count("trace_point", "ray", rays(lit_by(PointLight{{0.3, -0.2, 0.35}, {}})));
    count("trace_rect", "ray",
          rays(lit_by(RectLight{{0.3, -0.2, 0.6}, {0, 0.4, 0}, {0.4, 0, 0}, false})));
    count("trace_sky", "ray", rays(lit_by(EnvironmentLight{})));
}

void count_shade()
{
    const Stage& stage = terrain_stage(vertices);
    Progress progress;
    ShadeOptions options;
    options.threads = 1;
    const auto vertex_lights = [&](const Scene& scene) {
        return
            [&, scene, transport = trace(stage, scene, {}, progress), shaded = Shaded{}]() mutable {
                shaded = shade(stage, transport, scene, options, progress);
                return shaded.irradiance.size() * scene.lights.size();
            };
    };
    count("shade_lambert", "vertex-light", vertex_lights(four_lights(Lambert{})));
    count("shade_ggx", "vertex-light", vertex_lights(four_lights(make_cook_torrance({}))));
    options.radiance = false;
    count("another_power_E", "vertex-light", vertex_lights(four_lights(Lambert{})));
}

void count_bytes()
{
    const Stage& stage = terrain_stage(vertices);
    Progress progress;
    std::vector<Rgbf> radiance;
    for (const Dir3 n : stage.surface->normals) {
        radiance.push_back(to_float(Rgb::grey(Vec3(n).z)));
    }
    count("to_srgb8", "vertex", [&] { return to_srgb8(radiance, {}, 1, progress).size(); });

    const std::string& file = terrain_ply(vertices);
    count("read_ply", "vertex", [&] {
        const auto bytes = std::as_bytes(std::span(file.data(), file.size()));
        return read_ply(bytes, {}, progress)->positions.size();
    });
    const auto color = to_srgb8(radiance, {}, 1, progress);
    count("write_ply", "vertex", [&] {
        const LitMesh lit{*stage.mesh, stage.surface->normals, color, {}, {}};
        return write_ply(lit, PlyEncoding::BinaryLittleEndian).empty() ? 0 : color.size();
    });
}

}  // namespace
}  // namespace relight::bench

int main()
{
    relight::bench::count_geometry();
    relight::bench::count_trace();
    relight::bench::count_shade();
    relight::bench::count_bytes();
}
