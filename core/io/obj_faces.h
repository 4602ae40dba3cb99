#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/geometry/mesh.h"
#include "core/io/obj_corners.h"
#include "core/io/obj_words.h"
#include "core/io/readers.h"

namespace relight {

/// usemtl: names are numbered when a face first uses them.
class ObjMaterials {
  public:
    void use(std::string_view name);

    /// The face just filed, the `count`th, wears the current material.
    void wear(std::size_t count, Mesh& mesh);

  private:
    std::uint32_t number(std::string_view name, Mesh& mesh);

    std::optional<std::string_view> name_;               // of the last usemtl
    std::uint32_t current_ = ObjCorners::none;           // its number, once a face has used it
    std::map<std::string_view, std::uint32_t> numbers_;  // a tree: no crafted names make it slow
};

/// Files the faces of an OBJ file in a mesh, and what hangs on their corners beside it.
class ObjFaces {
  public:
    /// All of them must outlive it.
    ObjFaces(ObjWords& words, const ReadLimits& limits, Progress& progress, Mesh& mesh,
             ObjCorners& corners)
        : words_(words), limits_(limits), progress_(progress), mesh_(mesh), corners_(corners)
    {
    }

    void use_material(std::string_view name) { materials_.use(name); }

    /// The face whose corners are the words that follow. Errors: MalformedBody, IndexOutOfRange,
    /// TooManyFaces, Cancelled.
    std::optional<Error> add();

    /// At the end of the file: whether all that corners named before it was filed has come.
    std::optional<Error> none_missing() const;

  private:
    using Counts = std::array<std::size_t, 3>;  // of v, vt and vn lines

    /// Highest positive index named before its element was filed, and where.
    struct Ahead {
        std::uint64_t index = 0;
        std::uint64_t line = 0;
    };

    Counts so_far() const
    {
        return {mesh_.positions.size(), corners_.uvs.size(), corners_.normals.size()};
    }
    Result<std::uint32_t> index(std::string_view text, std::size_t filed, std::size_t kind);
    std::optional<Error> corner(std::string_view text, const Counts& filed);

    // Of every corner, and so inline: calls cost a seventh of the reading.

    /// Adds one corner of numbers that count from 1; 0 names nothing.
    void plain_corner(const std::array<std::uint32_t, 3>& numbers, const Counts& filed)
    {
        std::array<std::uint32_t, 3> found{ObjCorners::none, ObjCorners::none, ObjCorners::none};
        for (std::size_t kind = 0; kind < 3; ++kind) {
            if (numbers[kind] == 0) { continue; }
            found[kind] = numbers[kind] - 1;
            look_ahead(found[kind], filed[kind], kind);
        }
        file(found);
    }

    void look_ahead(std::uint32_t found, std::size_t filed, std::size_t kind)
    {
        if (found >= filed && (ahead_[kind].line == 0 || found > ahead_[kind].index)) {
            ahead_[kind] = {found, words_.line()};
        }
    }

    void file(const std::array<std::uint32_t, 3>& found)
    {
        file(corners_.uv_of, found[1]);
        file(corners_.normal_of, found[2]);
        mesh_.faces.indices.push_back(found[0]);
    }

    /// Arrays that no corner has needed so far stay empty.
    void file(std::vector<std::uint32_t>& named, std::uint32_t found) const
    {
        if (named.empty() && found == ObjCorners::none) { return; }
        if (named.size() < mesh_.faces.indices.size()) {  // the first corner that names one
            named.resize(mesh_.faces.indices.size(), ObjCorners::none);
        }
        named.push_back(found);
    }

    ObjWords& words_;
    const ReadLimits& limits_;
    Progress& progress_;
    Mesh& mesh_;
    ObjCorners& corners_;
    ObjMaterials materials_;
    std::array<Ahead, 3> ahead_{};
    std::size_t count_ = 0;
};

}  // namespace relight
