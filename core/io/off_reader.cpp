#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include "core/display/display.h"
#include "core/geometry/precision.h"
#include "core/io/coordinate.h"
#include "core/io/end_face.h"
#include "core/io/off_header.h"
#include "core/io/readers.h"
#include "core/io/utf8.h"

namespace relight {
namespace {

constexpr std::size_t block = 65'536;  // records between two looks at Progress

using Failure = std::optional<Error>;

/// Reads OFF, one vertex or face a line, with [ST][C][N] in any order before OFF.
class OffReader {
  public:
    OffReader(std::span<const std::byte> file, const ReadLimits& limits, Progress& progress)
        : words_(file), limits_(limits), progress_(progress)
    {
        mesh_.format = "off";
    }

    Result<Mesh> read()
    {
        auto header = off::read_header(words_, limits_);
        if (!header) { return std::move(header).error(); }
        header_ = *header;
        mesh_.positions.reserve(header_.vertices);
        mesh_.faces.indices.reserve(3 * header_.faces);
        for (std::size_t v = 0; v < header_.vertices; ++v) {
            if (v % block == 0 && progress_.stopped()) { return cancelled(); }
            if (auto failure = vertex()) { return std::move(*failure); }
        }
        for (std::size_t f = 0; f < header_.faces; ++f) {
            if (f % block == 0 && progress_.stopped()) { return cancelled(); }
            if (auto failure = face(f)) { return std::move(*failure); }
        }
        if (!words_.next_record().empty()) {
            return error(Fault::MalformedBody,
                         "more lines than the " + std::to_string(header_.vertices) +
                             " vertices and " + std::to_string(header_.faces) +
                             " faces of the header");
        }
        if (auto failure = decode_colors()) { return std::move(*failure); }
        mesh_.double_positions = float_loses_text(mesh_.positions);
        return std::move(mesh_);
    }

  private:
    Error error(Fault fault, std::string detail) const
    {
        return words_.error(fault, std::move(detail));
    }
    static Error cancelled() { return {Fault::Cancelled, "reading was stopped", {}, {}, {}}; }

    Error missing(std::size_t found, std::uint64_t announced, const char* what) const
    {
        return error(Fault::Truncated, "the file ends after " + std::to_string(found) + " of " +
                                           std::to_string(announced) + ' ' + what);
    }

    Failure vertex()
    {
        std::array<std::string_view, 13> words;  // one more than any vertex has
        std::size_t count = 0;
        for (std::string_view next = words_.next_record(); !next.empty() && count < words.size();
             next = words_.word()) {
            words[count++] = next;
        }
        if (count == 0) { return missing(mesh_.positions.size(), header_.vertices, "vertices"); }
        const std::size_t colors = count - std::min(count, header_.fixed());
        if (count < header_.fixed() ||
            (header_.colors ? colors != 3 && colors != 4 : colors != 0)) {
            return error(
                Fault::MalformedBody,
                "a vertex of " + std::to_string(count) + " numbers; the header announces " +
                    header_.shown() +
                    " (C before OFF for colours, N for normals, ST for texture coordinates)");
        }
        std::array<double, 13> n{};
        for (std::size_t i = 0; i < count; ++i) {
            const Result<double> number =
                parse_coordinate(words[i], header_.shown(), words_.line());
            if (!number) { return number.error(); }
            n[i] = *number;
        }
        mesh_.positions.push_back({n[0], n[1], n[2]});
        std::size_t at = 3;
        if (header_.normals) {
            mesh_.normals.push_back({n[at], n[at + 1], n[at + 2]});
            at += 3;
        }
        if (header_.colors) {
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
        if (header_.uvs) {
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
        const std::string_view first = words_.next_record();
        if (first.empty()) { return missing(filed, header_.faces, "faces"); }
        const Number<std::int64_t> corners = parse_integer(first);
        if (!corners || corners.value < 3) {
            return error(Fault::MalformedBody,
                         "a face of " + shown(first) +
                             " corners; expected their count, 3 or more, then their indices");
        }
        Faces& faces = mesh_.faces;
        for (std::int64_t c = 0; c < corners.value; ++c) {
            const std::string_view next = words_.word();
            const Number<std::int64_t> index = parse_integer(next);
            if (index.kind == NumberKind::Malformed) {
                return error(Fault::MalformedBody,
                             next.empty()
                                 ? "the line ends before the last of " + shown(first) + " indices"
                                 : shown(next) + " is no index of a vertex");
            }
            if (!index || index.value < 0 ||
                static_cast<std::uint64_t>(index.value) >= header_.vertices) {
                return error(Fault::IndexOutOfRange, "a corner names vertex " + shown(next) +
                                                         "; they are numbered 0 to " +
                                                         std::to_string(header_.vertices - 1));
            }
            faces.indices.push_back(static_cast<std::uint32_t>(index.value));
        }
        if (faces.indices.size() > 0xFFFFFFFF) {
            return error(Fault::TooManyFaces, "more than 4294967295 corners of faces");
        }
        end_face(faces, filed, static_cast<std::size_t>(corners.value));
        words_.rest_of_line();
        return {};
    }

    off::Words words_;
    const ReadLimits& limits_;
    Progress& progress_;
    Mesh mesh_;
    off::Header header_;
    bool codes_ = true;   // every colour so far is an integer
    double largest_ = 0;  // of the colours
    Failure no_code_;     // the first colour that can be no 8-bit code
};

}  // namespace

Result<Mesh> read_off(std::span<const std::byte> file, const ReadLimits& limits, Progress& progress)
{
    if (file.empty()) { return Error{Fault::EmptyFile, "the file has no bytes", {}, {}, {}}; }
    return OffReader(without_byte_order_mark(file), limits, progress).read();
}

}  // namespace relight
