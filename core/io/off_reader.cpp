#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include "core/display/display.h"
#include "core/geometry/precision.h"
#include "core/io/coordinate.h"
#include "core/io/readers.h"
#include "core/io/text_scanner.h"
#include "core/io/utf8.h"

namespace relight {
namespace {

constexpr std::size_t block = 65'536;  // records between two looks at Progress

using Failure = std::optional<Error>;

/// What the header's first word announces for each vertex, beside x y z.
struct Layout {
    bool uvs = false, colors = false, normals = false;

    std::size_t fixed() const { return 3U + (normals ? 3U : 0U) + (uvs ? 2U : 0U); }
    std::string shown() const
    {
        return std::string("x y z") + (normals ? " nx ny nz" : "") + (colors ? " r g b [a]" : "") +
               (uvs ? " s t" : "");
    }
};

/// Reads OFF, one vertex or face a line, with [ST][C][N] in any order before OFF.
class OffReader {
  public:
    OffReader(std::span<const std::byte> file, const ReadLimits& limits, Progress& progress)
        : scanner_(file), limits_(limits), progress_(progress)
    {
        mesh_.format = "off";
    }

    Result<Mesh> read()
    {
        if (auto failure = header()) { return std::move(*failure); }
        for (std::size_t v = 0; v < vertices_; ++v) {
            if (v % block == 0 && progress_.stopped()) { return cancelled(); }
            if (auto failure = vertex()) { return std::move(*failure); }
        }
        for (std::size_t f = 0; f < faces_; ++f) {
            if (f % block == 0 && progress_.stopped()) { return cancelled(); }
            if (auto failure = face(f)) { return std::move(*failure); }
        }
        if (!next_record().empty()) {
            return error(Fault::MalformedBody, "more lines than the " + std::to_string(vertices_) +
                                                   " vertices and " + std::to_string(faces_) +
                                                   " faces of the header");
        }
        if (auto failure = decode_colors()) { return std::move(*failure); }
        mesh_.double_positions = float_loses_text(mesh_.positions);
        return std::move(mesh_);
    }

  private:
    Error error(Fault fault, std::string detail) const
    {
        return {fault, std::move(detail), {}, line_, {}};
    }
    static Error cancelled() { return {Fault::Cancelled, "reading was stopped", {}, {}, {}}; }

    /// The next word on this line, empty at its end or from a comment on.
    std::string_view word()
    {
        const std::string_view next = scanner_.word();
        if (!next.starts_with('#')) { return next; }
        scanner_.rest_of_line();
        return {};
    }

    /// The first word of the next line that says something; empty at the end of the file.
    std::string_view next_record()
    {
        for (;;) {
            scanner_.next_line();
            line_ = scanner_.line();
            const std::string_view first = word();
            if (!first.empty() || scanner_.at_end()) { return first; }
        }
    }

    /// [ST][C][N]OFF, then the counts on the same line (even glued to the F, as whole collections
    /// have it) or on the next.
    Failure header()
    {
        line_ = scanner_.line();
        std::string_view first = word();
        if (first.empty()) { first = next_record(); }
        if (first.find("OFF") == std::string_view::npos) {
            return error(Fault::MalformedHeader,
                         "starts with " + shown(first) +
                             "; an OFF file starts with OFF, COFF, NOFF, STOFF or their like");
        }
        std::string_view left = first;
        while (!left.starts_with("OFF")) {
            if (left.starts_with('4') || left.starts_with('n')) {
                return error(
                    Fault::MalformedHeader,
                    shown(first) +
                        " has vertices of four or n numbers; send three, x y z, under OFF");
            }
            const bool two = left.starts_with("ST");
            bool* const kind = two                     ? &layout_.uvs
                               : left.starts_with('C') ? &layout_.colors
                               : left.starts_with('N') ? &layout_.normals
                                                       : nullptr;
            if (kind == nullptr || *kind) {
                return error(
                    Fault::MalformedHeader,
                    shown(first) +
                        " is no kind of OFF; known are ST, C and N, each once, before OFF");
            }
            *kind = true;
            left.remove_prefix(two ? 2 : 1);
        }
        left.remove_prefix(3);
        if (left.empty()) { left = word(); }
        if (left == "BINARY") {
            return error(Fault::MalformedHeader,
                         "OFF BINARY is not read; send ASCII OFF or binary PLY");
        }
        return counts(left.empty() ? next_record() : left);
    }

    /// Vertices, faces and perhaps edges, which nothing uses.
    Failure counts(std::string_view first)
    {
        std::array<std::uint64_t, 3> count{};
        std::size_t given = 0;
        for (std::string_view next = first; !next.empty(); next = word()) {
            const Number<std::int64_t> number = parse_integer(next);
            if (number.kind == NumberKind::OutOfRange) {
                return error(Fault::CountExceedsFile,
                             "announces " + shown(next) +
                                 " vertices, faces or edges, more than any file holds");
            }
            if (!number || number.value < 0 || given == count.size()) {
                return error(
                    Fault::MalformedHeader,
                    shown(next) + " in the line of counts; expected vertices, faces, edges");
            }
            count[given++] = static_cast<std::uint64_t>(number.value);
        }
        if (given < 2) {
            return error(Fault::MalformedHeader,
                         "the counts of vertices, faces and edges are missing");
        }
        const std::size_t left = scanner_.remaining() + 1;  // the last line may lack its end
        const std::size_t per_vertex = 2 * layout_.fixed() + (layout_.colors ? 6 : 0);
        constexpr std::size_t per_face = 8;  // "3 0 0 0" and a line's end
        if (count[0] > left / per_vertex || count[1] > (left - count[0] * per_vertex) / per_face) {
            return error(Fault::CountExceedsFile,
                         "announces " + std::to_string(count[0]) + " vertices and " +
                             std::to_string(count[1]) + " faces, more than the " +
                             std::to_string(left - 1) + " bytes that follow can hold");
        }
        if (count[0] == 0) { return error(Fault::NoGeometry, "announces 0 vertices"); }
        if (count[0] > std::min<std::uint64_t>(limits_.vertices, 0xFFFFFFFF)) {
            return error(Fault::TooManyVertices, "announces " + std::to_string(count[0]) +
                                                     " vertices; the limit is " +
                                                     std::to_string(limits_.vertices));
        }
        if (count[1] > limits_.faces) {
            return error(Fault::TooManyFaces, "announces " + std::to_string(count[1]) +
                                                  " faces; the limit is " +
                                                  std::to_string(limits_.faces));
        }
        vertices_ = count[0];
        faces_ = count[1];
        mesh_.positions.reserve(vertices_);
        mesh_.faces.indices.reserve(3 * faces_);
        return {};
    }

    Error missing(std::size_t found, std::uint64_t announced, const char* what) const
    {
        return error(Fault::Truncated, "the file ends after " + std::to_string(found) + " of " +
                                           std::to_string(announced) + ' ' + what);
    }

    Failure vertex()
    {
        std::array<std::string_view, 13> words;  // one more than any vertex has
        std::size_t count = 0;
        for (std::string_view next = next_record(); !next.empty() && count < words.size();
             next = word()) {
            words[count++] = next;
        }
        if (count == 0) { return missing(mesh_.positions.size(), vertices_, "vertices"); }
        const std::size_t colors = count - std::min(count, layout_.fixed());
        if (count < layout_.fixed() ||
            (layout_.colors ? colors != 3 && colors != 4 : colors != 0)) {
            return error(
                Fault::MalformedBody,
                "a vertex of " + std::to_string(count) + " numbers; the header announces " +
                    layout_.shown() +
                    " (C before OFF for colours, N for normals, ST for texture coordinates)");
        }
        std::array<double, 13> n{};
        for (std::size_t i = 0; i < count; ++i) {
            const Result<double> number = parse_coordinate(words[i], layout_.shown(), line_);
            if (!number) { return number.error(); }
            n[i] = *number;
        }
        mesh_.positions.push_back({n[0], n[1], n[2]});
        std::size_t at = 3;
        if (layout_.normals) {
            mesh_.normals.push_back({n[at], n[at + 1], n[at + 2]});
            at += 3;
        }
        if (layout_.colors) {
            mesh_.colors.push_back(to_float(Rgb{n[at], n[at + 1], n[at + 2]}));
            for (std::size_t i = at; i < at + 3; ++i) {
                codes_ = codes_ && static_cast<bool>(parse_integer(words[i]));
                largest_ = std::max(largest_, n[i]);
                if ((n[i] < 0 || n[i] > 255) && !no_code_) {
                    no_code_ = error(
                        Fault::MalformedBody,
                        "the colour " + shown(words[i]) +
                            " is no 8-bit code 0 to 255 (a colour written with a point is linear)");
                }
            }
            at += colors;
        }
        if (layout_.uvs) {
            mesh_.uvs.push_back({static_cast<float>(n[at]), static_cast<float>(n[at + 1])});
        }
        return {};
    }

    /// Colours written as integers are 8-bit sRGB codes; with a point in any of them, or none above
    /// 1, they are linear.
    Failure decode_colors()
    {
        if (!codes_ || largest_ <= 1) { return {}; }
        if (no_code_) { return no_code_; }
        for (Rgbf& color : mesh_.colors) {
            color = to_float(srgb_eotf(Rgb8{static_cast<unsigned char>(color[0]),
                                            static_cast<unsigned char>(color[1]),
                                            static_cast<unsigned char>(color[2])}));
        }
        return {};
    }

    /// "n i1 … in" and perhaps a colour of the face, which is passed over.
    Failure face(std::size_t filed)
    {
        const std::string_view first = next_record();
        if (first.empty()) { return missing(filed, faces_, "faces"); }
        const Number<std::int64_t> corners = parse_integer(first);
        if (!corners || corners.value < 3) {
            return error(Fault::MalformedBody,
                         "a face of " + shown(first) +
                             " corners; expected their count, 3 or more, then their indices");
        }
        Faces& faces = mesh_.faces;
        for (std::int64_t c = 0; c < corners.value; ++c) {
            const std::string_view next = word();
            const Number<std::int64_t> index = parse_integer(next);
            if (index.kind == NumberKind::Malformed) {
                return error(Fault::MalformedBody,
                             next.empty()
                                 ? "the line ends before the last of " + shown(first) + " indices"
                                 : shown(next) + " is no index of a vertex");
            }
            if (!index || index.value < 0 || static_cast<std::uint64_t>(index.value) >= vertices_) {
                return error(Fault::IndexOutOfRange, "a corner names vertex " + shown(next) +
                                                         "; they are numbered 0 to " +
                                                         std::to_string(vertices_ - 1));
            }
            faces.indices.push_back(static_cast<std::uint32_t>(index.value));
        }
        if (faces.indices.size() > 0xFFFFFFFF) {
            return error(Fault::TooManyFaces, "more than 4294967295 corners of faces");
        }
        if (corners.value != 3 && faces.offsets.empty()) {  // triangles so far
            for (std::size_t f = 0; f <= filed; ++f) {
                faces.offsets.push_back(static_cast<std::uint32_t>(3 * f));
            }
        }
        if (!faces.offsets.empty()) {
            faces.offsets.push_back(static_cast<std::uint32_t>(faces.indices.size()));
        }
        scanner_.rest_of_line();
        return {};
    }

    TextScanner scanner_;
    const ReadLimits& limits_;
    Progress& progress_;
    std::uint64_t line_ = 1;  // of the record at hand
    Mesh mesh_;
    Layout layout_;
    std::uint64_t vertices_ = 0, faces_ = 0;  // announced
    bool codes_ = true;                       // every colour so far is an integer
    double largest_ = 0;                      // of the colours
    Failure no_code_;                         // the first colour that can be no 8-bit code
};

}  // namespace

Result<Mesh> read_off(std::span<const std::byte> file, const ReadLimits& limits, Progress& progress)
{
    if (file.empty()) { return Error{Fault::EmptyFile, "the file has no bytes", {}, {}, {}}; }
    return OffReader(without_byte_order_mark(file), limits, progress).read();
}

}  // namespace relight
