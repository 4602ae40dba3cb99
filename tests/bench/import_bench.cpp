// What it costs to have a file decoded in a process of its own, beside decoding it right here.
#include <fstream>
#include <iterator>

#include "server/import/gltf.h"
#include "server/import_process.h"
#include "tests/bench/sizes.h"
#include "tests/bench/terrain.h"

namespace relight::bench {
namespace {

template <class Import>
void import(benchmark::State& state, const Import& import_file, const std::string& file)
{
    while (state.KeepRunning()) {
        const Result<Asset> asset = import_file(std::as_bytes(std::span(file)));
        if (!asset) {
            state.SkipWithError(asset.error().detail.c_str());
            break;
        }
        benchmark::DoNotOptimize(asset->mesh.positions.data());
    }
    rate(state, "bytes", file.size());
}

Result<Asset> by_process(std::span<const std::byte> file)
{
    Progress progress;
    return import_gltf(file, {}, progress);
}

Result<Asset> right_here(std::span<const std::byte> file)
{
    return decode_gltf(file, {});
}

void import_glb(benchmark::State& state)
{
    import(state, by_process, terrain_glb(vertices(state)));
}
BENCHMARK(import_glb)->Name("import GLB")->Apply(sizes);

void decode_glb(benchmark::State& state)
{
    import(state, right_here, terrain_glb(vertices(state)));
}
BENCHMARK(decode_glb)->Name("import GLB beside its decoding alone")->Apply(sizes);

void copy_glb(benchmark::State& state)
{
    copy_afresh(state, terrain_glb(vertices(state)));
}
BENCHMARK(copy_glb)->Name("import GLB beside memcpy to fresh memory")->Apply(sizes);

/// A file of 24 vertices: what remains is the process itself.
const std::string& box()
{
    static const std::string file = [] {
        std::ifstream stream(RELIGHT_TEST_DATA "/gltf/BoxVertexColors.glb", std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(stream), {});
    }();
    return file;
}

void box_only(benchmark::internal::Benchmark* b)
{
    b->Unit(benchmark::kMillisecond)->UseRealTime()->Arg(24);
}

void import_box(benchmark::State& state)
{
    import(state, by_process, box());
}
BENCHMARK(import_box)->Name("import a box")->Apply(box_only);

void decode_box(benchmark::State& state)
{
    import(state, right_here, box());
}
BENCHMARK(decode_box)->Name("import a box beside its decoding alone")->Apply(box_only);

}  // namespace
}  // namespace relight::bench
