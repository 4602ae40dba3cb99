#include "core/geometry/vertex_fields.h"

#include <algorithm>
#include <array>
#include <new>

#include "core/geometry/mesh.h"
#include "core/geometry/surface.h"

namespace relight {
namespace {

constexpr std::size_t doubles = 6;      // of a vertex
constexpr std::align_val_t line{64};    // of the processor's cache
constexpr std::size_t block = 1 << 14;  // vertices; some hundred microseconds

/// How far one field begins after the other: whole lines.
std::size_t stride_of(std::size_t vertices)
{
    constexpr std::size_t whole = VertexFields::spare;
    return (vertices + whole - 1) / whole * whole + whole;
}

}  // namespace

std::uint64_t VertexFields::bytes() const
{
    return memory ? stride_of(size()) * (doubles * sizeof(double) + sizeof(float)) : 0;
}

VertexFields vertex_fields(const Mesh& mesh, const Surface& surface,
                           std::span<const std::uint32_t> vertices, unsigned threads,
                           Progress& progress)
{
    const std::size_t count = vertices.size(), stride = stride_of(count);
    // Not set to zero first: whoever fills a page is the first to touch it.
    const std::shared_ptr<std::byte[]> memory(
        new (line) std::byte[stride * (doubles * sizeof(double) + sizeof(float))],
        [](std::byte* p) { ::operator delete[](p, line); });
    auto* const first = reinterpret_cast<double*>(memory.get());
    std::array<double*, doubles> field{};
    for (std::size_t f = 0; f < doubles; ++f) { field[f] = first + f * stride; }
    auto* const spacing = reinterpret_cast<float*>(first + doubles * stride);
    parallel_for(count, block, threads, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const std::size_t v = vertices[i];
            const Point3 p = mesh.positions[v];
            const Dir3 n = surface.normals[v];
            field[0][i] = p.x;
            field[1][i] = p.y;
            field[2][i] = p.z;
            field[3][i] = n.x();
            field[4][i] = n.y();
            field[5][i] = n.z();
            spacing[i] = surface.spacing[v];
        }
    });
    for (double* f : field) { std::fill(f + count, f + stride, 0.0); }
    std::fill(spacing + count, spacing + stride, 0.0F);
    const auto values = [&](std::size_t f) { return std::span<const double>(field[f], count); };
    return {values(0), values(1), values(2),        values(3),
            values(4), values(5), {spacing, count}, memory};
}

}  // namespace relight
