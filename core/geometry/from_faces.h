#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>

#include "core/geometry/corners.h"
#include "core/geometry/vertex_ranges.h"

namespace relight {

/// What the triangles at a vertex say of it.
struct AtVertex {
    static constexpr double unused = std::numeric_limits<double>::infinity();
    static constexpr double degenerate = TriangleBatch::none;

    Vec3 normal;  ///< angle-weighted (Thürmer and Wüthrich 1998), of any length; zero: none
    double shortest2 = unused;  ///< squared edge of a proper triangle; `unused`: by no triangle,
                                ///< `degenerate`: by none with an area
};

/// What they say together.
struct OfFaces {
    std::uint64_t degenerate = 0;
    bool wound_inward = false;  ///< Intake's
};

/// Sums over the triangles in their order. Calls take(first, vertices) for ranges of vertices, on
/// several threads: each vertex once.
/// @param centre of the mesh, so that volumes do not cancel
OfFaces sum_faces(std::span<const Point3> positions, std::span<const Triangle> triangles,
                  Point3 centre, const VertexRanges& ranges, Progress& progress,
                  const std::function<void(std::size_t, std::span<const AtVertex>)>& take);

}  // namespace relight
