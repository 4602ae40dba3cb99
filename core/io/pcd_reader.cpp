#include <algorithm>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <utility>

#include "core/geometry/precision.h"
#include "core/io/lzf.h"
#include "core/io/pcd_points.h"
#include "core/io/readers.h"
#include "core/io/text_scanner.h"

namespace relight {
namespace pcd {
namespace {

using Failure = std::optional<Error>;

/// Zeros, to the end of a memory page, are what PCL leaves behind a body; an editor, a line's end.
bool is_filler(std::span<const std::byte> bytes)
{
    return std::all_of(bytes.begin(), bytes.end(), [](std::byte b) {
        const char c = static_cast<char>(b);
        return c == '\0' || TextScanner::is_blank(c) || TextScanner::is_line_end(c);
    });
}

std::size_t length_at(const std::byte* at)
{
    std::uint32_t length = 0;
    std::memcpy(&length, at, sizeof(length));
    return length;
}

Error at_byte(Fault fault, std::size_t byte, std::string detail)
{
    return {fault, std::move(detail), {}, {}, byte};
}

/// The body's bytes; `body` is what follows the header.
Failure read_body(std::span<const std::byte> file, const Header& header, const Taken& taken,
                  Points& points, Progress& progress)
{
    const std::span<const std::byte> body = file.subspan(header.body);
    const std::string announced = "announces " + std::to_string(header.points) + " points of ";
    const std::string left = std::to_string(body.size()) + " that follow the header";
    if (header.encoding == Encoding::Ascii) {
        if (header.points > (body.size() + 1) / 2 / header.columns) {
            return Error{Fault::CountExceedsFile,
                         announced + std::to_string(header.columns) +
                             " numbers, more than the bytes can hold: there are " + left,
                         {},
                         header.body_line,
                         {}};
        }
        return read_text(file, header, taken, points, progress);
    }
    if (header.encoding == Encoding::Binary) {
        if (header.points > body.size() / header.stride) {
            return at_byte(
                Fault::CountExceedsFile, header.body,
                announced + std::to_string(header.stride) + " bytes, more than the " + left);
        }
        const std::size_t size = header.points * header.stride;
        if (!is_filler(body.subspan(size))) {
            return at_byte(Fault::MalformedBody, header.body + size,
                           announced + std::to_string(header.stride) + " bytes, fewer than the " +
                               left + ": a size or a count in the header is wrong");
        }
        return read_bytes(body, header.body, false, header, taken, points, progress);
    }
    constexpr std::size_t lengths = 8;
    if (body.size() < lengths) {
        return at_byte(
            Fault::Truncated, file.size(),
            "a compressed body starts with two lengths of 4 bytes; the file ends before");
    }
    const std::size_t packed = length_at(body.data());
    const std::size_t size = length_at(body.data() + 4);
    if (packed > body.size() - lengths) {
        return at_byte(Fault::CountExceedsFile, header.body,
                       "announces " + std::to_string(packed) +
                           " compressed bytes, more than the file has left, " +
                           std::to_string(body.size() - lengths));
    }
    if (header.points > UINT32_MAX / header.stride || header.points * header.stride != size) {
        return at_byte(Fault::MalformedBody, header.body + 4,
                       announced + std::to_string(header.stride) +
                           " bytes, but a body that unpacks to " + std::to_string(size));
    }
    if (!is_filler(body.subspan(lengths + packed))) {
        return at_byte(Fault::MalformedBody, header.body + lengths + packed,
                       "more bytes follow the compressed ones");
    }
    const auto unpacked = unpack_lzf(body.subspan(lengths, packed), size);
    if (!unpacked) {
        return at_byte(Fault::MalformedBody, header.body + lengths,
                       "the compressed bytes are no LZF data of " + std::to_string(size) +
                           " bytes: the file is damaged");
    }
    return read_bytes(*unpacked, header.body + lengths, true, header, taken, points, progress);
}

/// Where the scanner stood, if the file can be thought to say so: 0 0 0 is also what is written by
/// those who do not know, but among the points it cannot be true.
std::optional<Point3> told_viewpoint(std::optional<Point3> said, std::span<const Point3> points)
{
    if (!said || *said != Point3{}) { return said; }
    Point3 low = points.front(), high = low;
    for (const Point3& p : points) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    const auto holds_zero = [](double from, double to) { return from <= 0.0 && to >= 0.0; };
    if (holds_zero(low.x, high.x) && holds_zero(low.y, high.y) && holds_zero(low.z, high.z)) {
        return {};
    }
    return said;
}

}  // namespace
}  // namespace pcd

Result<Mesh> read_pcd(std::span<const std::byte> file, const ReadLimits& limits, Progress& progress)
{
    if (file.empty()) { return Error{Fault::EmptyFile, "the file has no bytes", {}, {}, {}}; }
    const Result<pcd::Header> header = pcd::read_header(file);
    if (!header) { return header.error(); }
    const std::uint64_t most = std::min<std::uint64_t>(limits.vertices, 0xFFFFFFFF);
    pcd::Points points;
    const Result<pcd::Taken> taken = pcd::take(*header, points.mesh.notes);
    if (!taken) { return taken.error(); }
    if (header->points > most) {
        return Error{Fault::TooManyVertices,
                     "announces " + std::to_string(header->points) + " points; the limit is " +
                         std::to_string(most),
                     {},
                     header->body_line - 1,
                     {}};
    }
    points.normals = (*taken)[pcd::normal_slot] != nullptr;
    points.colors = (*taken)[pcd::color_slot] != nullptr;
    if (auto failure = pcd::read_body(file, *header, *taken, points, progress)) {
        return std::move(*failure);
    }
    Mesh& mesh = points.mesh;
    if (auto failure = place_absent(mesh)) { return std::move(*failure); }
    mesh.format = "pcd";
    mesh.double_positions = header->encoding == pcd::Encoding::Ascii
                                ? float_loses_text(mesh.positions)
                                : float_loses(mesh.positions);
    mesh.viewpoint = pcd::told_viewpoint(header->viewpoint, mesh.positions);
    if (points.non_finite > 0) {
        mesh.notes.push_back(std::to_string(points.non_finite) +
                             " normals or colours are not finite: read as none, or black");
    }
    return std::move(points.mesh);
}

}  // namespace relight
