#include "core/io/off_header.h"

#include <algorithm>
#include <array>
#include <optional>

namespace relight::off {
namespace {

using Failure = std::optional<Error>;

/// Vertices, faces and perhaps edges, which nothing uses.
Failure read_counts(Words& words, std::string_view first, const ReadLimits& limits, Header& header)
{
    std::array<std::uint64_t, 3> count{};
    std::size_t given = 0;
    for (std::string_view next = first; !next.empty(); next = words.word()) {
        const Number<std::int64_t> number = parse_integer(next);
        if (number.kind == NumberKind::OutOfRange) {
            return words.error(
                Fault::CountExceedsFile,
                "announces " + shown(next) + " vertices, faces or edges, more than any file holds");
        }
        if (!number || number.value < 0 || given == count.size()) {
            return words.error(
                Fault::MalformedHeader,
                shown(next) + " in the line of counts; expected vertices, faces, edges");
        }
        count[given++] = static_cast<std::uint64_t>(number.value);
    }
    if (given < 2) {
        return words.error(Fault::MalformedHeader,
                           "the counts of vertices, faces and edges are missing");
    }
    const std::size_t left = words.remaining() + 1;  // the last line may lack its end
    const std::size_t per_vertex = 2 * header.fixed() + (header.colors ? 6 : 0);
    constexpr std::size_t per_face = 8;  // "3 0 0 0" and a line's end
    if (count[0] > left / per_vertex || count[1] > (left - count[0] * per_vertex) / per_face) {
        return words.error(Fault::CountExceedsFile,
                           "announces " + std::to_string(count[0]) + " vertices and " +
                               std::to_string(count[1]) + " faces, more than the " +
                               std::to_string(left - 1) + " bytes that follow can hold");
    }
    if (count[0] == 0) { return words.error(Fault::NoGeometry, "announces 0 vertices"); }
    if (count[0] > std::min<std::uint64_t>(limits.vertices, 0xFFFFFFFF)) {
        return words.error(Fault::TooManyVertices, "announces " + std::to_string(count[0]) +
                                                       " vertices; the limit is " +
                                                       std::to_string(limits.vertices));
    }
    if (count[1] > limits.faces) {
        return words.error(Fault::TooManyFaces, "announces " + std::to_string(count[1]) +
                                                    " faces; the limit is " +
                                                    std::to_string(limits.faces));
    }
    header.vertices = count[0];
    header.faces = count[1];
    return {};
}

}  // namespace

/// [ST][C][N]OFF, then the counts on the same line (even glued to the F, as whole collections
/// have it) or on the next.
Result<Header> read_header(Words& words, const ReadLimits& limits)
{
    Header header;
    std::string_view first = words.word();
    if (first.empty()) { first = words.next_record(); }
    if (first.find("OFF") == std::string_view::npos) {
        return words.error(Fault::MalformedHeader,
                           "starts with " + shown(first) +
                               "; an OFF file starts with OFF, COFF, NOFF, STOFF or their like");
    }
    std::string_view left = first;
    while (!left.starts_with("OFF")) {
        if (left.starts_with('4') || left.starts_with('n')) {
            return words.error(
                Fault::MalformedHeader,
                shown(first) + " has vertices of four or n numbers; send three, x y z, under OFF");
        }
        const bool two = left.starts_with("ST");
        bool* const kind = two                     ? &header.uvs
                           : left.starts_with('C') ? &header.colors
                           : left.starts_with('N') ? &header.normals
                                                   : nullptr;
        if (kind == nullptr || *kind) {
            return words.error(
                Fault::MalformedHeader,
                shown(first) + " is no kind of OFF; known are ST, C and N, each once, before OFF");
        }
        *kind = true;
        left.remove_prefix(two ? 2 : 1);
    }
    left.remove_prefix(3);
    if (left.empty()) { left = words.word(); }
    if (left == "BINARY") {
        return words.error(Fault::MalformedHeader,
                           "OFF BINARY is not read; send ASCII OFF or binary PLY");
    }
    if (left.empty()) { left = words.next_record(); }
    if (auto failure = read_counts(words, left, limits, header)) { return std::move(*failure); }
    return header;
}

}  // namespace relight::off
