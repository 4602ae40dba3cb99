#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "core/io/readers.h"
#include "core/io/utf8.h"
#include "tests/io/mutants.h"

namespace relight::test {

using Reader = Result<Mesh> (*)(std::span<const std::byte>, const ReadLimits&, Progress&);

inline Result<Mesh> read(Reader reader, std::string_view text, const ReadLimits& limits = {})
{
    Progress progress;
    return reader(std::as_bytes(std::span(text)), limits, progress);
}

/// True if two readings hold the same; notes, which say how the file was written, may differ.
inline bool same(const Mesh& a, const Mesh& b)
{
    return a.format == b.format && a.positions == b.positions && a.absent == b.absent &&
           a.viewpoint == b.viewpoint && a.double_positions == b.double_positions &&
           a.faces.indices == b.faces.indices && a.faces.offsets == b.faces.offsets &&
           a.normals == b.normals && a.colors == b.colors && a.uvs == b.uvs &&
           a.corner_uvs == b.corner_uvs && a.materials == b.materials &&
           a.face_materials == b.face_materials;
}

/// True if some note of the mesh contains `words`.
inline bool notes_say(const Mesh& mesh, std::string_view words)
{
    return std::any_of(mesh.notes.begin(), mesh.notes.end(), [&](const std::string& note) {
        return note.find(words) != std::string::npos;
    });
}

/// Every promise of mesh.h and readers.h about what a reader returns: the first one that `mesh`,
/// read from a file of `bytes`, breaks; empty if it keeps them all.
inline std::string broken_promise(const Mesh& mesh, std::size_t bytes)
{
    const std::size_t vertices = mesh.positions.size();
    const Faces& faces = mesh.faces;
    const auto all = [](const auto& values, auto good) {
        return std::all_of(values.begin(), values.end(), good);
    };
    const auto finite = [](const auto& numbers) {
        return std::all_of(numbers.begin(), numbers.end(),
                           [](float x) { return std::isfinite(x); });
    };
    const auto good_position = [](Point3 p) {
        return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= largest_coordinate &&
               is_finite(p);
    };
    const auto none_or = [](std::size_t size, std::size_t full) {
        return size == 0 || size == full;
    };
    if (vertices == 0) { return "no vertices"; }
    if (!all(mesh.positions, good_position)) { return "a position is not finite or too large"; }
    if (!faces.indices.empty() && !mesh.absent.empty()) { return "a face among absent points"; }
    if (mesh.absent.size() >= vertices) { return "no point is present"; }
    if (std::adjacent_find(mesh.absent.begin(), mesh.absent.end(), std::greater_equal<>()) !=
            mesh.absent.end() ||
        (!mesh.absent.empty() && mesh.absent.back() >= vertices)) {
        return "the absent points do not ascend, or there are too few vertices";
    }
    if (mesh.viewpoint && !good_position(*mesh.viewpoint)) {
        return "the viewpoint is not finite or too large";
    }
    if (!all(faces.indices, [&](std::uint32_t i) { return i < vertices; })) {
        return "an index is out of range";
    }
    if (faces.offsets.empty()
            ? faces.indices.size() % 3 != 0
            : faces.offsets.front() != 0 || faces.offsets.back() != faces.indices.size()) {
        return "the offsets do not span the indices";
    }
    for (std::size_t f = 0; f < faces.count(); ++f) {
        if (faces.end(f) < faces.begin(f) + 3) { return "a face has fewer than three corners"; }
    }
    if (!none_or(mesh.normals.size(), vertices) || !none_or(mesh.colors.size(), vertices) ||
        !none_or(mesh.uvs.size(), vertices) ||
        !none_or(mesh.corner_uvs.size(), faces.indices.size()) ||
        !none_or(mesh.face_materials.size(), faces.count())) {
        return "an array has the wrong length";
    }
    if (!all(mesh.normals, [](Vec3 n) { return is_finite(n); })) {
        return "a normal is not finite";
    }
    if (!all(mesh.colors, finite) || !all(mesh.uvs, finite) || !all(mesh.corner_uvs, finite)) {
        return "a colour or texture coordinate is not finite";
    }
    if (!all(mesh.face_materials, [&](std::uint32_t m) { return m < mesh.materials.size(); })) {
        return "a face's material is out of range";
    }
    if (!all(mesh.materials, is_utf8) || !all(mesh.notes, is_utf8)) { return "text is not UTF-8"; }
    const std::size_t held =
        vertices * sizeof(Point3) + 4 * (faces.indices.size() + faces.offsets.size()) +
        4 * mesh.absent.size() + 24 * mesh.normals.size() + 12 * mesh.colors.size() +
        8 * (mesh.uvs.size() + mesh.corner_uvs.size()) + 4 * mesh.face_materials.size();
    const std::size_t packed = mesh.format == "pcd" ? 88 : 1;  // LZF: 264 bytes from three
    if (held > 32 * packed * bytes) { return "the mesh takes more than 32 times its file"; }
    return {};
}

/// The first promise that a reader breaks on `text`: a mesh that is not what mesh.h says, or an
/// error that says nothing, or no place for a fault that has one.
inline std::string broken_promise(Reader reader, std::string_view text)
{
    const Result<Mesh> mesh = read(reader, text);
    if (mesh) { return broken_promise(*mesh, text.size()); }
    const Error& error = mesh.error();
    if (error.detail.empty() || !is_utf8(error.detail)) {
        return "an error without a readable text";
    }
    const bool whole_file = error.fault == Fault::EmptyFile || error.fault == Fault::NoGeometry;
    if (!whole_file && !error.line && !error.byte) { return "an error without a place"; }
    return {};
}

/// The first promise that a reader breaks on `text` cut or mutated (mutants.h).
inline std::string broken_promise_of_mutants(Reader reader, const std::string& text, int count,
                                             unsigned seed)
{
    return broken_promise_of_mutants(
        [&](std::string_view mutant) { return broken_promise(reader, mutant); }, text, count, seed);
}

}  // namespace relight::test
