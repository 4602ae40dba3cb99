#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "core/geometry/precision.h"
#include "core/io/obj_corners.h"
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

/// usemtl: names are numbered when a face first uses them.
class MaterialNames {
  public:
    void use(std::string_view name)
    {
        name_ = name;
        current_ = none;
    }

    /// The face just filed, the `count`th, wears the current material.
    void wear(std::size_t count, Mesh& mesh)
    {
        if (!name_) { return; }
        if (mesh.face_materials.empty() && count > 1) {  // faces before the first usemtl
            mesh.face_materials.resize(count - 1, number("", mesh));
        }
        if (current_ == none) { current_ = number(*name_, mesh); }
        mesh.face_materials.push_back(current_);
    }

  private:
    std::uint32_t number(std::string_view name, Mesh& mesh)
    {
        const auto next = static_cast<std::uint32_t>(mesh.materials.size());
        const auto [place, fresh] = numbers_.try_emplace(name, next);
        if (fresh) { mesh.materials.push_back(as_utf8(name)); }
        return place->second;
    }

    std::optional<std::string_view> name_;               // of the last usemtl
    std::uint32_t current_ = none;                       // its number, once a face has used it
    std::map<std::string_view, std::uint32_t> numbers_;  // a tree: no crafted names make it slow
};

class ObjReader {
  public:
    ObjReader(std::span<const std::byte> file, const ReadLimits& limits, Progress& progress)
        : words_(file), limits_(limits), progress_(progress)
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
    using Counts = std::array<std::size_t, 3>;  // of v, vt and vn lines

    /// Highest positive index named before its element was filed, and where.
    struct Ahead {
        std::uint64_t index = 0;
        std::uint64_t line = 0;
    };

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
            return face();
        }
        if (keyword == "usemtl") {
            names_.use(words_.name());
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

    /// An index counts from 1, or from -1 backwards from what has been filed so far. A positive one
    /// may look ahead: `finished` checks the highest of those.
    Result<std::uint32_t> index(std::string_view text, std::size_t filed, std::size_t kind)
    {
        const Number<std::int64_t> number = parse_integer(text);
        if (number.kind == NumberKind::Malformed) {
            return error(Fault::MalformedBody,
                         shown(text) + " is no index; a corner is v, v/vt, v//vn or v/vt/vn");
        }
        const auto count = static_cast<std::int64_t>(filed);
        const std::int64_t i = number.value < 0 ? count + number.value : number.value - 1;
        if (!number || i < 0 || i >= none) {
            return error(Fault::IndexOutOfRange,
                         shown(text) + " names none of the " + std::to_string(filed) + ' ' +
                             kinds[kind] +
                             " lines so far; indices count from 1, or from -1 backwards");
        }
        const auto found = static_cast<std::uint32_t>(i);
        look_ahead(found, filed, kind);
        return found;
    }

    /// Adds one corner: v, v/vt, v//vn or v/vt/vn; "v/" and "v//" name nothing more than v.
    Failure corner(std::string_view text, const Counts& filed)
    {
        std::array<std::uint32_t, 3> found{none, none, none};
        std::size_t kind = 0;
        for (std::string_view left = text;; ++kind) {
            const std::size_t slash = std::min(left.find('/'), left.size());
            if (kind == 3 || (kind == 0 && slash == 0)) {
                return error(Fault::MalformedBody,
                             shown(text) + " is no corner; expected v, v/vt, v//vn or v/vt/vn");
            }
            if (slash > 0) {
                const Result<std::uint32_t> i = index(left.substr(0, slash), filed[kind], kind);
                if (!i) { return i.error(); }
                found[kind] = *i;
            }
            if (slash == left.size()) { break; }
            left.remove_prefix(slash + 1);
        }
        add(found);
        return {};
    }

    /// Adds one corner of numbers that count from 1; 0 names nothing.
    void plain_corner(const std::array<std::uint32_t, 3>& numbers, const Counts& filed)
    {
        std::array<std::uint32_t, 3> found{none, none, none};
        for (std::size_t kind = 0; kind < 3; ++kind) {
            if (numbers[kind] == 0) { continue; }
            found[kind] = numbers[kind] - 1;
            look_ahead(found[kind], filed[kind], kind);
        }
        add(found);
    }

    Counts so_far() const
    {
        return {mesh_.positions.size(), corners_.uvs.size(), corners_.normals.size()};
    }

    void look_ahead(std::uint32_t found, std::size_t filed, std::size_t kind)
    {
        if (found >= filed && (ahead_[kind].line == 0 || found > ahead_[kind].index)) {
            ahead_[kind] = {found, words_.line()};
        }
    }

    void add(const std::array<std::uint32_t, 3>& found)
    {
        add(corners_.uv_of, found[1]);
        add(corners_.normal_of, found[2]);
        mesh_.faces.indices.push_back(found[0]);
    }

    /// Arrays that no corner has needed so far stay empty.
    void add(std::vector<std::uint32_t>& named, std::uint32_t found) const
    {
        if (named.empty() && found == none) { return; }
        if (named.size() < mesh_.faces.indices.size()) {  // the first corner that names one
            named.resize(mesh_.faces.indices.size(), none);
        }
        named.push_back(found);
    }

    Failure face()
    {
        Faces& faces = mesh_.faces;
        const std::size_t begin = faces.indices.size();
        const Counts filed = so_far();
        std::array<std::uint32_t, 3> numbers{};
        for (;;) {
            if (words_.plain_corner(numbers)) {
                plain_corner(numbers, filed);
            } else {
                const std::string_view next = words_.word();
                if (next.empty()) { break; }
                if (auto failure = corner(next, filed)) { return failure; }
            }
            if (faces.indices.size() % block == 0 && progress_.stopped()) { return cancelled(); }
        }
        const std::size_t corners = faces.indices.size() - begin;
        if (corners < 3) {
            return error(Fault::MalformedBody, "a face of " + std::to_string(corners) +
                                                   " corners; it needs three or more");
        }
        if (face_count_ >= limits_.faces || faces.indices.size() > none) {
            return error(Fault::TooManyFaces, "more faces than the limit of " +
                                                  std::to_string(limits_.faces) +
                                                  "; send a coarser mesh or one in parts");
        }
        if (corners != 3 && faces.offsets.empty()) {  // triangles so far
            for (std::size_t i = 0; i <= face_count_; ++i) {
                faces.offsets.push_back(static_cast<std::uint32_t>(3 * i));
            }
        }
        if (!faces.offsets.empty()) {
            faces.offsets.push_back(static_cast<std::uint32_t>(faces.indices.size()));
        }
        ++face_count_;
        names_.wear(face_count_, mesh_);
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
        const Counts filed = so_far();
        for (std::size_t kind = 0; kind < filed.size(); ++kind) {
            if (ahead_[kind].line > 0 && ahead_[kind].index >= filed[kind]) {
                return Error{Fault::IndexOutOfRange,
                             "a corner names " + std::string(kinds[kind]) + ' ' +
                                 std::to_string(ahead_[kind].index + 1) + "; the file has " +
                                 std::to_string(filed[kind]),
                             {},
                             ahead_[kind].line,
                             {}};
            }
        }
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

    static constexpr std::array<const char*, 3> kinds{"v", "vt", "vn"};

    ObjWords words_;
    const ReadLimits& limits_;
    Progress& progress_;
    Mesh mesh_;
    ObjCorners corners_;
    MaterialNames names_;
    LeftOut left_out_;
    std::array<Ahead, 3> ahead_{};
    std::size_t face_count_ = 0, coloured_ = 0;
};

}  // namespace

Result<Mesh> read_obj(std::span<const std::byte> file, const ReadLimits& limits, Progress& progress)
{
    if (file.empty()) { return Error{Fault::EmptyFile, "the file has no bytes", {}, {}, {}}; }
    return ObjReader(without_byte_order_mark(file), limits, progress).read();
}

}  // namespace relight
