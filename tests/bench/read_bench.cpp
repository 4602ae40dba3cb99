#include <array>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <cstring>

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

template <class T>
void append(std::string& file, T value)
{
    file.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

/// The terrain's vertices as LAS 1.2, point format 3: time and R G B, 34 bytes each.
std::string terrain_las(std::size_t count)
{
    const std::vector<Point3>& points = terrain_stage(count).mesh->positions;
    std::string file = "LASF";
    file.resize(227);
    file[24] = 1;
    file[25] = 2;
    file[104] = 3;
    const auto put = [&](std::size_t at, auto value) {
        std::memcpy(file.data() + at, &value, sizeof(value));
    };
    put(94, std::uint16_t{227});
    put(96, std::uint32_t{227});
    put(105, std::uint16_t{34});
    put(107, static_cast<std::uint32_t>(points.size()));
    for (const std::size_t at : {131U, 139U, 147U}) { put(at, 1e-9); }
    for (const Point3& p : points) {
        for (const double c : {p.x, p.y, p.z}) { append(file, static_cast<std::int32_t>(c * 1e9)); }
        file.append(16, '\0');
        for (const double c : {p.x, p.y, p.z}) {
            append(file, static_cast<std::uint16_t>(c * 32767 + 32767));
        }
    }
    return file;
}

/// x y z rgb as PCL writes them, 16 bytes a point.
std::string terrain_pcd(std::size_t count)
{
    const std::vector<Point3>& points = terrain_stage(count).mesh->positions;
    const std::string n = std::to_string(points.size());
    std::string file =
        "VERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH " + n +
        "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + n + "\nDATA binary\n";
    for (const Point3& p : points) {
        for (const double c : {p.x, p.y, p.z}) { append(file, static_cast<float>(c)); }
        append(file, std::uint32_t{0x4080C0});
    }
    return file;
}

/// x y z of six decimals and r g b, a line each.
std::string terrain_xyz(std::size_t count)
{
    std::string file;
    for (const Point3& p : terrain_stage(count).mesh->positions) {
        std::array<char, 64> line{};
        const int size =
            std::snprintf(line.data(), line.size(), "%.6f %.6f %.6f 64 128 192\n", p.x, p.y, p.z);
        file.append(line.data(), static_cast<std::size_t>(size));
    }
    return file;
}

void read_las_file(benchmark::State& state)
{
    read(state, read_las, terrain_las(vertices(state)));
}
BENCHMARK(read_las_file)->Name("read LAS")->Apply(sizes);

void copy_las_file_afresh(benchmark::State& state)
{
    copy_afresh(state, terrain_las(vertices(state)));
}
BENCHMARK(copy_las_file_afresh)->Name("read LAS beside memcpy to fresh memory")->Apply(sizes);

void read_pcd_file(benchmark::State& state)
{
    read(state, read_pcd, terrain_pcd(vertices(state)));
}
BENCHMARK(read_pcd_file)->Name("read binary PCD")->Apply(sizes);

void copy_pcd_file_afresh(benchmark::State& state)
{
    copy_afresh(state, terrain_pcd(vertices(state)));
}
BENCHMARK(copy_pcd_file_afresh)
    ->Name("read binary PCD beside memcpy to fresh memory")
    ->Apply(sizes);

void read_xyz_file(benchmark::State& state)
{
    read(state, read_xyz, terrain_xyz(vertices(state)));
}
BENCHMARK(read_xyz_file)->Name("read XYZ")->Apply(sizes);

void convert_xyz_numbers(benchmark::State& state)
{
    const std::string file = terrain_xyz(vertices(state));
    while (state.KeepRunning()) {
        benchmark::DoNotOptimize(sum_of_numbers(file.data(), file.data() + file.size()));
    }
    rate(state, "bytes", file.size());
}
BENCHMARK(convert_xyz_numbers)->Name("read XYZ beside from_chars, 1 thread")->Apply(sizes);

}  // namespace
}  // namespace relight::bench
