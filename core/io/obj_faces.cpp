#include "core/io/obj_faces.h"

#include <algorithm>
#include <string>

#include "core/io/end_face.h"
#include "core/io/utf8.h"

namespace relight {
namespace {

constexpr std::uint32_t none = ObjCorners::none;
constexpr std::size_t block = 65'536;  // corners between two looks at Progress
constexpr std::array<const char*, 3> kinds{"v", "vt", "vn"};

}  // namespace

void ObjMaterials::use(std::string_view name)
{
    name_ = name;
    current_ = none;
}

void ObjMaterials::wear(std::size_t count, Mesh& mesh)
{
    if (!name_) { return; }
    if (mesh.face_materials.empty() && count > 1) {  // faces before the first usemtl
        mesh.face_materials.resize(count - 1, number("", mesh));
    }
    if (current_ == none) { current_ = number(*name_, mesh); }
    mesh.face_materials.push_back(current_);
}

std::uint32_t ObjMaterials::number(std::string_view name, Mesh& mesh)
{
    const auto next = static_cast<std::uint32_t>(mesh.materials.size());
    const auto [place, fresh] = numbers_.try_emplace(name, next);
    if (fresh) { mesh.materials.push_back(as_utf8(name)); }
    return place->second;
}

/// An index counts from 1, or from -1 backwards from what has been filed so far. A positive one
/// may look ahead: none_missing() checks the highest of those.
Result<std::uint32_t> ObjFaces::index(std::string_view text, std::size_t filed, std::size_t kind)
{
    const Number<std::int64_t> number = parse_integer(text);
    if (number.kind == NumberKind::Malformed) {
        return words_.error(Fault::MalformedBody,
                            shown(text) + " is no index; a corner is v, v/vt, v//vn or v/vt/vn");
    }
    const auto count = static_cast<std::int64_t>(filed);
    const std::int64_t i = number.value < 0 ? count + number.value : number.value - 1;
    if (!number || i < 0 || i >= none) {
        return words_.error(Fault::IndexOutOfRange,
                            shown(text) + " names none of the " + std::to_string(filed) + ' ' +
                                kinds[kind] +
                                " lines so far; indices count from 1, or from -1 backwards");
    }
    const auto found = static_cast<std::uint32_t>(i);
    look_ahead(found, filed, kind);
    return found;
}

/// Adds one corner: v, v/vt, v//vn or v/vt/vn; "v/" and "v//" name nothing more than v.
std::optional<Error> ObjFaces::corner(std::string_view text, const Counts& filed)
{
    std::array<std::uint32_t, 3> found{none, none, none};
    std::size_t kind = 0;
    for (std::string_view left = text;; ++kind) {
        const std::size_t slash = std::min(left.find('/'), left.size());
        if (kind == 3 || (kind == 0 && slash == 0)) {
            return words_.error(Fault::MalformedBody,
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
    file(found);
    return {};
}

std::optional<Error> ObjFaces::add()
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
        if (faces.indices.size() % block == 0 && progress_.stopped()) {
            return Error{Fault::Cancelled, "reading was stopped", {}, {}, {}};
        }
    }
    const std::size_t corners = faces.indices.size() - begin;
    if (corners < 3) {
        return words_.error(Fault::MalformedBody, "a face of " + std::to_string(corners) +
                                                      " corners; it needs three or more");
    }
    if (count_ >= limits_.faces || faces.indices.size() > none) {
        return words_.error(Fault::TooManyFaces, "more faces than the limit of " +
                                                     std::to_string(limits_.faces) +
                                                     "; send a coarser mesh or one in parts");
    }
    end_face(faces, count_, corners);
    ++count_;
    materials_.wear(count_, mesh_);
    return {};
}

std::optional<Error> ObjFaces::none_missing() const
{
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
    return {};
}

}  // namespace relight
