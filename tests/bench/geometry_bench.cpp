#include <algorithm>
#include <cmath>

#include "core/geometry/morton.h"
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
        const Surface surface = prepare(mesh, threads(state), progress);
        benchmark::DoNotOptimize(surface.normals.data());
    }
    rate(state, "vertices", mesh.positions.size());
}
BENCHMARK(prepare_mesh)->Name("prepare: normals, spacing, order")->Apply(sizes_and_threads);

/// As one writes angle-weighted normals first: one pass over the faces, three arctangents each.
void normals_by_atan2(benchmark::State& state)
{
    const Mesh& mesh = *terrain_stage(vertices(state)).mesh;
    while (state.KeepRunning()) {
        std::vector<Vec3> sums(mesh.positions.size());
        for (std::size_t c = 0; c < mesh.faces.indices.size(); c += 3) {
            const std::uint32_t* t = &mesh.faces.indices[c];
            for (std::size_t k = 0; k < 3; ++k) {
                const Point3 p = mesh.positions[t[k]];
                const Vec3 a = mesh.positions[t[(k + 1) % 3]] - p;
                const Vec3 b = mesh.positions[t[(k + 2) % 3]] - p;
                const Vec3 normal = cross(a, b);
                const double area2 = length(normal);
                sums[t[k]] += normal * (std::atan2(area2, dot(a, b)) / area2);
            }
        }
        std::vector<Dir3> normals(sums.size());
        std::transform(sums.begin(), sums.end(), normals.begin(), normalize);
        benchmark::DoNotOptimize(normals.data());
    }
    rate(state, "vertices", mesh.positions.size());
}
BENCHMARK(normals_by_atan2)
    ->Name("prepare: normals, spacing, order beside normals by atan2, 1 thread")
    ->Apply(sizes_and_threads);

/// What prepare() reads, and as much as it leaves behind.
void copy_arrays(benchmark::State& state)
{
    const Mesh& mesh = *terrain_stage(vertices(state)).mesh;
    while (state.KeepRunning()) {
        const std::vector<Point3> as_normals = mesh.positions;
        const std::vector<std::uint32_t> as_triangles = mesh.faces.indices;
        benchmark::DoNotOptimize(as_normals.data());
        benchmark::DoNotOptimize(as_triangles.data());
    }
    rate(state, "vertices", mesh.positions.size());
}
BENCHMARK(copy_arrays)
    ->Name("prepare: normals, spacing, order beside a copy of the mesh, 1 thread")
    ->Apply(sizes_and_threads);

void order_points(benchmark::State& state)
{
    const Stage& stage = terrain_stage(vertices(state));
    while (state.KeepRunning()) {
        Progress progress;
        const auto order =
            morton_order(stage.mesh->positions, stage.surface->bounds, threads(state), progress);
        benchmark::DoNotOptimize(order.data());
    }
    rate(state, "vertices", stage.mesh->positions.size());
}
BENCHMARK(order_points)->Name("Morton order")->Apply(sizes_and_threads);

/// std::sort of as many numbers of 64 bits, codes made already.
void sort_codes(benchmark::State& state)
{
    const std::vector<std::uint32_t>& order = terrain_stage(vertices(state)).surface->order;
    while (state.KeepRunning()) {
        std::vector<std::uint64_t> codes(order.begin(), order.end());
        for (std::size_t i = 0; i < codes.size(); ++i) { codes[i] = codes[i] << 32 | i; }
        std::sort(codes.begin(), codes.end());
        benchmark::DoNotOptimize(codes.data());
    }
    rate(state, "vertices", order.size());
}
BENCHMARK(sort_codes)->Name("Morton order beside std::sort, 1 thread")->Apply(sizes_and_threads);

void prepare_cloud(benchmark::State& state)
{
    Mesh cloud = *terrain_stage(vertices(state)).mesh;
    cloud.faces = {};
    while (state.KeepRunning()) {
        Progress progress;
        const Surface surface = prepare(cloud, threads(state), progress);
        benchmark::DoNotOptimize(surface.normals.data());
    }
    rate(state, "vertices", cloud.positions.size());
}
BENCHMARK(prepare_cloud)->Name("prepare: cloud, normals estimated")->Apply(sizes_and_threads);

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
