#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "core/base/parallel.h"
#include "core/base/vec.h"

namespace relight {

struct Mesh;
struct Surface;

/// What a receiver of light is, of some vertices in some order, field by field: vector code reads
/// its lanes as they lie. Copies share the memory, which nobody changes.
struct VertexFields {
    static constexpr std::size_t spare = 16;  // beyond the last there are zeros: vectors read whole

    std::span<const double> p_x, p_y, p_z;  ///< Mesh::positions
    std::span<const double> n_x, n_y, n_z;  ///< Surface::normals
    std::span<const float> spacing;         ///< Surface::spacing
    std::shared_ptr<const void> memory;

    std::size_t size() const { return spacing.size(); }
    Point3 p(std::size_t i) const { return {p_x[i], p_y[i], p_z[i]}; }
    Dir3 n(std::size_t i) const { return unit_already({n_x[i], n_y[i], n_z[i]}); }
    std::uint64_t bytes() const;
};

/// Those of `vertices`, in that order. Of no use once `progress` is stopped.
VertexFields vertex_fields(const Mesh& mesh, const Surface& surface,
                           std::span<const std::uint32_t> vertices, unsigned threads,
                           Progress& progress);

}  // namespace relight
