#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include "core/geometry/precision.h"
#include "core/io/obj_corners.h"
#include "core/io/obj_faces.h"
#include "core/io/obj_words.h"
#include "core/io/readers.h"
#include "core/io/utf8.h"

namespace relight {
namespace {

constexpr std::uint32_t none = ObjCorners::none;
constexpr std::size_t block = 65'536;  // elements between two looks at Progress

using Failure = std::optional<Error>;

/// What the file holds beside what is read, for the notes.
struct LeftOut {
    bool mtllib = false;
    std::size_t lines = 0, points = 0, weights = 0, unknown = 0;
    std::vector<std::string> keywords;  // the first few unknown ones

    void add(std::string_view keyword)
    {
        constexpr std::size_t listed = 6;
        std::string name = shown(keyword);
        ++unknown;
        if (keywords.size() < listed &&
            std::find(keywords.begin(), keywords.end(), name) == keywords.end()) {
            keywords.push_back(std::move(name));
        }
    }
};

class ObjReader {
  public:
    ObjReader(std::span<const std::byte> file, const ReadLimits& limits, Progress& progress)
        : words_(file),
          limits_(limits),
          progress_(progress),
          faces_(words_, limits, progress, mesh_, corners_)
    {
        mesh_.format = "obj";
    }

    Result<Mesh> read()
    {
        for (std::size_t lines = 1; !words_.at_end(); ++lines) {
            if (lines % block == 0 && progress_.stopped()) { return cancelled(); }
            if (auto failure = statement(words_.keyword())) { return std::move(*failure); }
            words_.next_statement();
        }
        return finished();
    }

  private:
    Error error(Fault fault, std::string detail) const
    {
        return words_.error(fault, std::move(detail));
    }
    static Error cancelled() { return {Fault::Cancelled, "reading was stopped", {}, {}, {}}; }

    Failure statement(std::string_view keyword)
    {
        if (keyword == "v") { return position(); }
        if (keyword == "vt") { return texture_coordinate(); }
        if (keyword == "vn") { return normal(); }
        if (keyword == "f" || keyword == "fo") {  // fo: f of the oldest files
            return faces_.add();
        }
        if (keyword == "usemtl") {
            faces_.use_material(words_.name());
        } else if (keyword == "mtllib") {
            left_out_.mtllib = true;
        } else if (keyword == "l") {
            ++left_out_.lines;
        } else if (keyword == "p") {
            ++left_out_.points;
        } else if (!keyword.empty() && keyword != "g" && keyword != "o" && keyword != "s") {
            left_out_.add(keyword);
        }
        return {};
    }

    Failure position()
    {
        std::array<double, 7> n{};
        const Result<std::size_t> read = words_.numbers(n, 3, "v x y z [w] [r g b]");
        if (!read) { return read.error(); }
        const std::size_t count = *read;
        if (count == 5) {
            return error(Fault::MalformedBody, "5 numbers; expected v x y z [w] [r g b]");
        }
        if (mesh_.positions.size() >= std::min<std::uint64_t>(limits_.vertices, none)) {
            return error(Fault::TooManyVertices, "more vertices than the limit of " +
                                                     std::to_string(limits_.vertices) +
                                                     "; send a coarser mesh or one in parts");
        }
        mesh_.positions.push_back({n[0], n[1], n[2]});
        if (count == 4 || count == 7) { left_out_.weights += n[3] != 1.0 ? 1 : 0; }
        if (count >= 6) {
            const std::size_t r = count - 3;
            mesh_.colors.resize(mesh_.positions.size() - 1, Rgbf{1, 1, 1});
            mesh_.colors.push_back(to_float(Rgb{n[r], n[r + 1], n[r + 2]}));
            ++coloured_;
        }
        return {};
    }

    Failure texture_coordinate()
    {
        std::array<double, 3> n{};
        const Result<std::size_t> read = words_.numbers(n, 1, "vt u [v] [w]");
        if (!read) { return read.error(); }
        corners_.uvs.push_back({static_cast<float>(n[0]), static_cast<float>(n[1])});
        return {};
    }

    Failure normal()
    {
        std::array<double, 3> n{};
        const Result<std::size_t> read = words_.numbers(n, 3, "vn x y z");
        if (!read) { return read.error(); }
        corners_.normals.push_back({n[0], n[1], n[2]});
        return {};
    }

    Result<Mesh> finished()
    {
        if (mesh_.positions.empty()) {
            return Error{Fault::NoGeometry,
                         "no vertices; an OBJ file gives each on a line 'v x y z'",
                         {},
                         {},
                         {}};
        }
        if (auto failure = faces_.none_missing()) { return std::move(*failure); }
        if (!mesh_.colors.empty()) { mesh_.colors.resize(mesh_.positions.size(), Rgbf{1, 1, 1}); }
        mesh_.double_positions = float_loses_text(mesh_.positions);
        write_notes();
        return with_normals(with_uvs(std::move(mesh_), corners_), corners_);
    }

    void write_notes()
    {
        const auto note = [&](std::size_t count, const std::string& what) {
            if (count > 0) { mesh_.notes.push_back(std::to_string(count) + what); }
        };
        if (left_out_.mtllib) {
            mesh_.notes.emplace_back(
                "mtllib is not followed: materials keep their names, the request says what they "
                "are");
        }
        note(left_out_.lines, " line elements (l) left out: lines are not lit");
        note(left_out_.points, " point elements (p) left out: every vertex is lit as it is");
        note(left_out_.weights, " vertices have a weight w other than 1, which is not used");
        note(words_.swapped_exponents(),
             " numbers have their exponent's sign before its letter; 3.1+e2 is read as 3.1e+2");
        if (!mesh_.colors.empty()) {
            note(mesh_.positions.size() - coloured_,
                 " vertices have no colour while others do: they are white");
        }
        std::string keywords;
        for (const std::string& name : left_out_.keywords) {
            keywords += (keywords.empty() ? "" : ", ") + name;
        }
        note(left_out_.unknown, " lines of other keywords left out: " + keywords);
    }

    ObjWords words_;
    const ReadLimits& limits_;
    Progress& progress_;
    Mesh mesh_;
    ObjCorners corners_;
    ObjFaces faces_;
    LeftOut left_out_;
    std::size_t coloured_ = 0;
};

}  // namespace

Result<Mesh> read_obj(std::span<const std::byte> file, const ReadLimits& limits, Progress& progress)
{
    if (file.empty()) { return Error{Fault::EmptyFile, "the file has no bytes", {}, {}, {}}; }
    return ObjReader(without_byte_order_mark(file), limits, progress).read();
}

}  // namespace relight
