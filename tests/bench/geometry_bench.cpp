#include "tests/bench/raw_embree.h"
#include "tests/bench/sizes.h"
#include "tests/bench/terrain.h"

namespace relight::bench {
namespace {

void prepare_mesh(benchmark::State& state)
{
    const Mesh& mesh = *terrain_stage(vertices(state)).mesh;
    while (state.KeepRunning()) {
        Progress progress;
        const Surface surface = prepare(mesh, 0, progress);
        benchmark::DoNotOptimize(surface.normals.data());
    }
    rate(state, "vertices", mesh.positions.size());
}
BENCHMARK(prepare_mesh)->Name("prepare: normals, spacing")->Apply(sizes);

void inspect_mesh(benchmark::State& state)
{
    const Stage& stage = terrain_stage(vertices(state));
    while (state.KeepRunning()) {
        benchmark::DoNotOptimize(inspect(*stage.mesh, *stage.surface).boundary_edges);
    }
    rate(state, "vertices", stage.mesh->positions.size());
}
BENCHMARK(inspect_mesh)->Name("inspect: topology, once a mesh")->Apply(sizes);

void build_bvh(benchmark::State& state)
{
    const Stage& stage = terrain_stage(vertices(state));
    while (state.KeepRunning()) {
        const Bvh bvh(*stage.mesh, *stage.surface);
        benchmark::DoNotOptimize(bvh.bytes());
    }
    rate(state, "triangles", stage.surface->triangles.size());
}
BENCHMARK(build_bvh)->Name("build BVH")->Apply(sizes);

void commit_raw(benchmark::State& state)
{
    const Stage& stage = terrain_stage(vertices(state));
    RawEmbree& raw = terrain_embree(vertices(state));
    while (state.KeepRunning()) { raw.commit(); }
    rate(state, "triangles", stage.surface->triangles.size());
}
BENCHMARK(commit_raw)->Name("build BVH beside rtcCommitScene")->Apply(sizes);

}  // namespace
}  // namespace relight::bench
