#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/geometry/mesh.h"
#include "core/io/end_face.h"
#include "core/io/ply_source.h"

namespace relight::ply {

/// Loops ask whether to stop once in so many records.
inline constexpr std::uint64_t block = std::uint64_t{1} << 16;

/// Which lists of the face element we take.
struct FaceLayout {
    std::size_t corners{};                  ///< place of vertex_indices
    std::optional<std::size_t> corner_uvs;  ///< place of texcoord: u v a corner
};

/// Errors: MalformedHeader.
Result<FaceLayout> layout_of(const Element& face);

/// Reads faces one value at a time; `first` of them are in `mesh` already.
template <class Source>
class FaceReader {
  public:
    FaceReader(Source& source, const Element& face, const FaceLayout& layout, Mesh& mesh,
               std::uint64_t vertices)
        : source_(source), face_(face), layout_(layout), mesh_(mesh), vertices_(vertices)
    {
    }

    Result<Done> read(std::uint64_t first, Progress& progress)
    {
        for (std::uint64_t f = first; f < face_.count; ++f) {
            if (f % block == 0 && progress.stopped()) {
                return Error{Fault::Cancelled, "stopped while reading faces", {}, {}, {}};
            }
            Result<Done> read = read_face(f);
            if (!read) { return read; }
        }
        return Done{};
    }

  private:
    Result<Done> read_face(std::uint64_t f)
    {
        source_.begin_record();
        const std::size_t begin = mesh_.faces.indices.size();
        const std::size_t uv_begin = mesh_.corner_uvs.size();
        uvs_.clear();
        for (std::size_t i = 0; i < face_.properties.size(); ++i) {
            Result<Done> read = read_property(i, f);
            if (!read) { return read; }
        }
        if (!source_.end_record()) { return source_.failure(); }
        return finish_face(f, begin, uv_begin);
    }

    Result<Done> read_property(std::size_t i, std::uint64_t f)
    {
        const Property& property = face_.properties[i];
        if (!property.count) {
            if (!source_.skip(property.type, 1)) { return source_.failure(); }
            return Done{};
        }
        const std::optional<double> count = source_.next(*property.count);
        if (!count) { return source_.failure(); }
        if (*count < 0.0) {
            return source_.error(Fault::MalformedBody, place(f) + " has a list of negative length");
        }
        const auto length = static_cast<std::uint64_t>(*count);
        if (!source_.can_hold(property.type, length)) {
            return source_.error(Fault::CountExceedsFile,
                                 place(f) + " announces a list of " + std::to_string(length) +
                                     " values, more than the rest of the file can hold");
        }
        if (i == layout_.corners) { return read_corners(property.type, length, f); }
        if (i == layout_.corner_uvs) { return read_uvs(property.type, length); }
        if (!source_.skip(property.type, length)) { return source_.failure(); }
        return Done{};
    }

    Result<Done> read_corners(Scalar type, std::uint64_t count, std::uint64_t f)
    {
        if (count < 3) {
            return source_.error(Fault::MalformedBody, place(f) + " has " + std::to_string(count) +
                                                           " corners; 3 or more are needed");
        }
        if (mesh_.faces.indices.size() + count > std::numeric_limits<std::uint32_t>::max()) {
            return source_.error(Fault::TooManyFaces, "faces have more than 2^32 - 1 corners");
        }
        for (std::uint64_t k = 0; k < count; ++k) {
            const std::optional<double> index = source_.next(type);
            if (!index) { return source_.failure(); }
            if (*index < 0.0 || *index >= static_cast<double>(vertices_)) {
                return source_.error(Fault::IndexOutOfRange,
                                     place(f) + " names vertex " +
                                         std::to_string(static_cast<std::int64_t>(*index)) +
                                         "; the file has vertices 0 to " +
                                         std::to_string(vertices_ - 1));
            }
            mesh_.faces.indices.push_back(static_cast<std::uint32_t>(*index));
        }
        return Done{};
    }

    Result<Done> read_uvs(Scalar type, std::uint64_t count)
    {
        for (std::uint64_t k = 0; k < count; ++k) {
            const std::optional<double> value = source_.next(type);
            if (!value) { return source_.failure(); }
            const bool finite = std::abs(*value) <= std::numeric_limits<float>::max();
            uvs_.push_back(finite ? static_cast<float>(*value) : 0.0F);
        }
        return Done{};
    }

    Result<Done> finish_face(std::uint64_t f, std::size_t begin, std::size_t uv_begin)
    {
        const std::size_t corners = mesh_.faces.indices.size() - begin;
        end_face(mesh_.faces, f, corners);
        if (!layout_.corner_uvs) { return Done{}; }
        if (!uvs_.empty() && uvs_.size() != 2 * corners) {
            return source_.error(Fault::MalformedBody,
                                 place(f) + " has " + std::to_string(uvs_.size()) +
                                     " texcoord values for " + std::to_string(corners) +
                                     " corners; two a corner, or none, are needed");
        }
        mesh_.corner_uvs.resize(uv_begin + corners);
        for (std::size_t k = 0; k < uvs_.size(); ++k) {
            mesh_.corner_uvs[uv_begin + k / 2][k % 2] = uvs_[k];
        }
        return Done{};
    }

    static std::string place(std::uint64_t f) { return "face " + std::to_string(f); }

    Source& source_;
    const Element& face_;
    const FaceLayout& layout_;
    Mesh& mesh_;
    std::uint64_t vertices_;
    std::vector<float> uvs_;  // of the face being read
};

/// The plainest body, and the most common: little endian, a uchar length of 3, three 32-bit
/// indices, among scalars. Takes such triangles from the front of `bytes` into `mesh` until one is
/// anything else (which FaceReader then reads or refuses), and says how many it took.
std::uint64_t take_triangles(std::span<const std::byte> bytes, const Element& face,
                             const FaceLayout& layout, Mesh& mesh, std::uint64_t vertices,
                             Progress& progress);

/// Bytes of the records that take_triangles takes; nothing if `face` is not of that kind.
std::optional<std::size_t> plain_triangle_stride(const Element& face, const FaceLayout& layout);

}  // namespace relight::ply
