#include <charconv>

#include "core/io/readers.h"
#include "tests/bench/sizes.h"
#include "tests/bench/terrain.h"

namespace relight::bench {
namespace {

template <class Reader>
void read(benchmark::State& state, const Reader& reader, const std::string& file)
{
    while (state.KeepRunning()) {
        Progress progress;
        const auto mesh = reader(std::as_bytes(std::span(file)), ReadLimits{}, progress);
        if (!mesh) {
            state.SkipWithError(mesh.error().detail.c_str());
            break;
        }
        benchmark::DoNotOptimize(mesh->positions.data());
    }
    rate(state, "bytes", file.size());
}

void read_ply_file(benchmark::State& state)
{
    read(state, read_ply, terrain_ply(vertices(state)));
}
BENCHMARK(read_ply_file)->Name("read PLY")->Apply(sizes);

void copy_ply_file(benchmark::State& state)
{
    copy(state, terrain_ply(vertices(state)));
}
BENCHMARK(copy_ply_file)->Name("read PLY beside memcpy")->Apply(sizes);

void copy_ply_file_afresh(benchmark::State& state)
{
    copy_afresh(state, terrain_ply(vertices(state)));
}
BENCHMARK(copy_ply_file_afresh)->Name("read PLY beside memcpy to fresh memory")->Apply(sizes);

void read_obj_file(benchmark::State& state)
{
    read(state, read_obj, terrain_obj(vertices(state)));
}
BENCHMARK(read_obj_file)->Name("read OBJ")->Apply(sizes);

bool is_numeric(char c)
{
    return (c >= '0' && c <= '9') || c == '-' || c == '.';
}

/// Every number of the text, whole ones in the lines of faces, and nothing else looked at.
double sum_of_numbers(const char* at, const char* end)
{
    double sum = 0.0;
    bool in_face = false;
    while (at != end) {
        if (*at == 'f' || *at == 'v') { in_face = *at == 'f'; }
        if (!is_numeric(*at)) {
            ++at;
        } else if (in_face) {
            unsigned index = 0;
            at = std::from_chars(at, end, index).ptr;
            sum += index;
        } else {
            double number = 0.0;
            at = std::from_chars(at, end, number).ptr;
            sum += number;
        }
    }
    return sum;
}

void convert_obj_numbers(benchmark::State& state)
{
    const std::string& file = terrain_obj(vertices(state));
    while (state.KeepRunning()) {
        benchmark::DoNotOptimize(sum_of_numbers(file.data(), file.data() + file.size()));
    }
    rate(state, "bytes", file.size());
}
BENCHMARK(convert_obj_numbers)->Name("read OBJ beside from_chars, 1 thread")->Apply(sizes);

}  // namespace
}  // namespace relight::bench
