#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/geometry/mesh.h"
#include "core/io/ply_header.h"

namespace relight::ply {

/// What we take from a vertex: x y z, nx ny nz, red green blue, u v, at these places.
using Row = std::array<double, 11>;
inline constexpr std::size_t position_slot = 0, normal_slot = 3, color_slot = 6, uv_slot = 9;

/// For each property its place in a Row; nothing: skipped.
using Slots = std::vector<std::optional<std::size_t>>;

/// Checks the values of vertices and puts them into a mesh.
class VertexSink {
  public:
    /// Finds the properties that we take. Errors: MalformedHeader.
    static Result<VertexSink> of(const Element& vertex);

    const Slots& slots() const { return slots_; }

    /// The file has no faces: a vertex with a NaN coordinate is an absent point (Mesh::absent),
    /// which place_absent() is then to move.
    void allow_absent() { absent_allowed_ = true; }

    /// Takes room for `count` vertices, which the file must be known to hold.
    void reserve(Mesh& mesh, std::size_t count) const;

    struct Refusal {
        std::size_t row;
        Fault fault;
        std::string detail;
    };
    /// Adds the vertices `first`, `first` + 1 ..., the next; says which was refused first, if any.
    std::optional<Refusal> put(Mesh& mesh, std::size_t first, std::span<const Row> rows);

    /// Notes what was left out, and decides whether float would lose positions.
    void finish(Mesh& mesh, Encoding encoding) const;

  private:
    bool bind(const Element& vertex, std::span<const std::string_view> names, std::size_t slot);
    void bind_colors(const Element& vertex);
    void bind_uvs(const Element& vertex);
    void resize(Mesh& mesh, std::size_t count) const;
    float finite_or_zero(double value);

    Slots slots_;
    bool normals_ = false, colors_ = false, uvs_ = false;
    bool absent_allowed_ = false;
    bool float_positions_ = true;     // declared as types that fit into a float
    std::vector<float> color_table_;  // linear value of each integer code; empty: filed as floats
    double uv_scale_ = 1.0;           // 1/255 for uchar
    std::uint64_t non_finite_ = 0;    // values beside positions that were not finite
    std::vector<std::string> notes_;
};

}  // namespace relight::ply
