#include <algorithm>
#include <cmath>
#include <string>

#include "core/io/coordinate.h"
#include "core/io/las_header.h"
#include "core/io/readers.h"
#include "core/io/srgb_codes.h"

namespace relight {
namespace {

constexpr std::size_t block = 8192;  // points, whose part of the arrays stays in the cache

/// Positions of points [first, first + n). Error: CoordinateTooLarge.
std::optional<Error> read_positions(std::span<const std::byte> file, const LasHeader& header,
                                    std::size_t first, std::size_t n, Mesh& mesh)
{
    const std::byte* const records = file.data() + header.points;
    const auto [sx, sy, sz] = header.scale;
    const auto [ox, oy, oz] = header.offset;
    bool good = true;
    for (std::size_t i = first; i < first + n; ++i) {
        const auto at = las_value<std::array<std::int32_t, 3>>(records + i * header.length);
        const Point3 p = {at[0] * sx + ox, at[1] * sy + oy, at[2] * sz + oz};
        mesh.positions[i] = p;
        good = good && is_placed(p);
    }
    for (std::size_t i = first; !good; ++i) {
        if (auto failure = misplaced(i, mesh.positions[i])) {
            failure->byte = header.points + i * header.length;
            return failure;
        }
    }
    return {};
}

/// The largest code among the colours of points [first, first + n), which are decoded by `table`.
unsigned read_colors(std::span<const std::byte> file, const LasHeader& header, std::size_t first,
                     std::size_t n, std::span<const float> table, Mesh& mesh)
{
    const std::byte* const codes = file.data() + header.points + las_formats[header.format].rgb;
    unsigned largest = 0;
    for (std::size_t i = first; i < first + n; ++i) {
        const auto [r, g, b] = las_value<std::array<std::uint16_t, 3>>(codes + i * header.length);
        largest = std::max<unsigned>(largest, std::max({r, g, b}));
        mesh.colors[i] = {table[r], table[g], table[b]};
    }
    return largest;
}

}  // namespace

Result<Mesh> read_las(std::span<const std::byte> file, const ReadLimits& limits, Progress& progress)
{
    const Result<LasHeader> header = read_las_header(file);
    if (!header) { return header.error(); }
    const std::uint64_t most = std::min<std::uint64_t>(limits.vertices, 0xFFFFFFFF);
    if (header->count > most) {
        return Error{Fault::TooManyVertices,
                     "announces " + std::to_string(header->count) + " points; the limit is " +
                         std::to_string(most),
                     {},
                     {},
                     107};
    }
    static const std::vector<float> table = decoded_srgb(65'535);  // takes longer than a small file
    const bool colors = las_formats[header->format].rgb != 0;
    Mesh mesh;
    mesh.format = "las";
    mesh.double_positions = true;
    mesh.positions.reserve(header->count);
    if (colors) { mesh.colors.reserve(header->count); }
    unsigned largest = 0;
    for (std::size_t first = 0; first < header->count; first += block) {
        if (progress.stopped()) {
            return Error{Fault::Cancelled, "reading was stopped", {}, {}, {}};
        }
        const std::size_t n = std::min(block, header->count - first);
        mesh.positions.resize(first + n);
        if (auto failure = read_positions(file, *header, first, n, mesh)) {
            return std::move(*failure);
        }
        if (!colors) { continue; }
        mesh.colors.resize(first + n);
        largest = std::max(largest, read_colors(file, *header, first, n, table, mesh));
    }
    if (largest > 0 && largest <= 255) {
        read_colors(file, *header, 0, header->count, decoded_srgb(255), mesh);
        mesh.notes.emplace_back("no colour is above 255: read as 8-bit codes");
    }
    if (const std::size_t rest = file.size() - header->end(); rest > 0 && header->minor < 3) {
        mesh.notes.push_back(std::to_string(rest) + " bytes after the last point left out");
    }
    return mesh;
}

}  // namespace relight
