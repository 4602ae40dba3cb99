#include <charconv>

#include "core/display/display.h"
#include "core/io/fields_writer.h"
#include "core/io/writers.h"
#include "core/shade/shade.h"
#include "tests/bench/sizes.h"
#include "tests/bench/terrain.h"
#include "tests/scenes.h"
#include "tests/written.h"

namespace relight::bench {
namespace {

/// The usual answer: irradiance as floats, and the colour that a display shows.
struct Answer {
    const Mesh* mesh;
    Shaded shaded;
    UnsetVector<Rgb8> color;

    std::span<const float> irradiance() const
    {
        return {shaded.irradiance.data()->data(), 3 * shaded.irradiance.size()};
    }
    LitMesh lit() const
    {
        return {*mesh, {}, color, {{"irradiance", 3, irradiance()}}, {"irradiance in W/m^2"}};
    }
};

const Answer& answer(std::size_t vertices)
{
    static std::map<std::size_t, Answer> answers;
    const auto [at, is_new] = answers.try_emplace(vertices);
    if (is_new) {
        const Stage& stage = terrain_stage(vertices);
        Scene scene;
        scene.lights = {test::light_of(PointLight{{0.3, -0.2, 0.35}, {}}, {3.0, 2.5, 2.0})};
        Progress progress;
        Shaded shaded = shade(stage, trace(stage, scene, {}, progress), scene, {}, progress);
        UnsetVector<Rgb8> color = to_srgb8(shaded.radiance, {}, 0, progress);
        at->second = {stage.mesh.get(), std::move(shaded), std::move(color)};
    }
    return at->second;
}

std::string binary_ply(const LitMesh& lit)
{
    return write_ply(lit, PlyEncoding::BinaryLittleEndian);
}

using Writer = std::string (*)(const LitMesh&);

void write_mesh(benchmark::State& state, Writer writer)
{
    const LitMesh lit = answer(vertices(state)).lit();
    std::size_t bytes = 0;
    while (state.KeepRunning()) {
        const std::string file = writer(lit);
        benchmark::DoNotOptimize(file.data());
        bytes = file.size();
    }
    rate(state, "bytes", bytes);
}

void copy_mesh(benchmark::State& state, Writer writer)
{
    copy(state, writer(answer(vertices(state)).lit()));
}

void copy_mesh_afresh(benchmark::State& state, Writer writer)
{
    copy_afresh(state, writer(answer(vertices(state)).lit()));
}
BENCHMARK_CAPTURE(write_mesh, ply, binary_ply)->Name("write PLY")->Apply(sizes);
BENCHMARK_CAPTURE(copy_mesh, ply, binary_ply)->Name("write PLY beside memcpy")->Apply(sizes);
BENCHMARK_CAPTURE(copy_mesh_afresh, ply, binary_ply)
    ->Name("write PLY beside memcpy to fresh memory")
    ->Apply(sizes);
BENCHMARK_CAPTURE(write_mesh, npz, write_npz)->Name("write NPZ")->Apply(sizes);
BENCHMARK_CAPTURE(copy_mesh, npz, write_npz)->Name("write NPZ beside memcpy")->Apply(sizes);
BENCHMARK_CAPTURE(copy_mesh_afresh, npz, write_npz)
    ->Name("write NPZ beside memcpy to fresh memory")
    ->Apply(sizes);
BENCHMARK_CAPTURE(write_mesh, obj, write_obj)->Name("write OBJ")->Apply(sizes);
BENCHMARK_CAPTURE(copy_mesh, obj, write_obj)->Name("write OBJ beside memcpy")->Apply(sizes);
BENCHMARK_CAPTURE(write_mesh, vtp, write_vtp)->Name("write VTP")->Apply(sizes);
BENCHMARK_CAPTURE(copy_mesh, vtp, write_vtp)->Name("write VTP beside memcpy")->Apply(sizes);

/// Written as it is sent: nobody holds all of it.
void send(benchmark::State& state, const std::function<Encoding(const Answer&)>& encode)
{
    const Answer& a = answer(vertices(state));
    std::uint64_t bytes = 0;
    while (state.KeepRunning()) {
        const Encoding encoding = encode(a);
        encoding.write([](std::string_view block) {
            benchmark::DoNotOptimize(block.data());
            benchmark::ClobberMemory();
            return true;
        });
        bytes = encoding.bytes;
    }
    rate(state, "bytes", bytes);
}

void copy_sent(benchmark::State& state, const std::function<Encoding(const Answer&)>& encode)
{
    copy(state, whole(encode(answer(vertices(state)))));
}

Encoding ply(const Answer& a)
{
    return encode_ply(a.lit());
}

template <FieldType type>
Encoding irradiance(const Answer& a)
{
    return encode_fields(a.color.size(), {{"irradiance", type, 3, a.irradiance(), "W/m2"}});
}

Encoding color(const Answer& a)
{
    return encode_fields(a.color.size(), {{"color", FieldType::UInt8, 3,
                                           std::span<const Rgb8>(a.color), "sRGB 8-bit"}});
}
BENCHMARK_CAPTURE(send, ply, ply)->Name("send PLY")->Apply(sizes);
BENCHMARK_CAPTURE(copy_sent, ply, ply)->Name("send PLY beside memcpy")->Apply(sizes);
BENCHMARK_CAPTURE(send, f32, irradiance<FieldType::Float32>)
    ->Name("send irradiance, float32")
    ->Apply(sizes);
BENCHMARK_CAPTURE(copy_sent, f32, irradiance<FieldType::Float32>)
    ->Name("send irradiance, float32 beside memcpy")
    ->Apply(sizes);
BENCHMARK_CAPTURE(send, f16, irradiance<FieldType::Float16>)
    ->Name("send irradiance, float16")
    ->Apply(sizes);
BENCHMARK_CAPTURE(copy_sent, f16, irradiance<FieldType::Float16>)
    ->Name("send irradiance, float16 beside memcpy")
    ->Apply(sizes);
BENCHMARK_CAPTURE(send, color, color)->Name("send color, uint8")->Apply(sizes);
BENCHMARK_CAPTURE(copy_sent, color, color)->Name("send color, uint8 beside memcpy")->Apply(sizes);

void write_json_numbers(benchmark::State& state)
{
    const auto values = answer(vertices(state)).irradiance();
    while (state.KeepRunning()) {
        std::string text;
        append_json(text, values, 3);
        benchmark::DoNotOptimize(text.data());
    }
    rate(state, "vertices", values.size() / 3);
}
BENCHMARK(write_json_numbers)->Name("write JSON numbers")->Apply(sizes);

void convert_numbers(benchmark::State& state)
{
    const auto values = answer(vertices(state)).irradiance();
    while (state.KeepRunning()) {
        std::array<char, 32> digits{};
        for (const float value : values) {
            benchmark::DoNotOptimize(
                std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
        }
    }
    rate(state, "vertices", values.size() / 3);
}
BENCHMARK(convert_numbers)->Name("write JSON numbers beside to_chars, 1 thread")->Apply(sizes);

void display_colors(benchmark::State& state)
{
    const Answer& a = answer(vertices(state));
    while (state.KeepRunning()) {
        Progress progress;
        benchmark::DoNotOptimize(to_srgb8(a.shaded.radiance, {}, 1, progress).data());
    }
    rate(state, "vertices", a.color.size());
}
BENCHMARK(display_colors)->Name("display: linear to sRGB, 1 thread")->Apply(sizes);

void display_by_formula(benchmark::State& state)
{
    const Answer& a = answer(vertices(state));
    std::vector<Rgb8> codes(a.color.size());
    while (state.KeepRunning()) {
        for (std::size_t i = 0; i < codes.size(); ++i) {
            codes[i] = to_srgb8(to_double(a.shaded.radiance[i]), {});
        }
        benchmark::ClobberMemory();
    }
    rate(state, "vertices", codes.size());
}
BENCHMARK(display_by_formula)
    ->Name("display: linear to sRGB, 1 thread beside the formula in double")
    ->Apply(sizes);

}  // namespace
}  // namespace relight::bench
