#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/base/vec.h"

namespace relight {

/// A number of triangles side by side, axis by axis, as vector instructions want them.
struct TriangleBatch {
    static constexpr std::size_t size = 128;  ///< with its results it fits into the L1 cache
    template <class T>
    using Row = std::array<T, size>;

    // Given.
    std::array<std::array<Row<double>, 3>, 3> corner;  ///< [k][axis], finite
    Point3 centre;                                     ///< whence `volume6` is seen

    // Found. A triangle whose corners are collinear to within rounding is degenerate: it has no
    // side to be lit.
    std::array<Row<double>, 3> doubled_area;  ///< normal times twice the area
    Row<double> area2;                        ///< its length; 0: degenerate
    Row<double> volume6;                      ///< six times that of the tetrahedron from `centre`
    std::array<Row<double>, 3> weight;        ///< angle at corner k [rad] / area2; 0: degenerate
    std::array<Row<double>, 3> shorter2;      ///< squared: the shorter edge at corner k, or `none`

    static constexpr double none = 1e300;  ///< longer than any edge, squared
};

/// Finds what is to be found. Weights are within 1e-15 of their size; everything else is rounded as
/// plain double arithmetic rounds it, and all of it is the same on every processor.
/// Test: Corners.*
void measure(TriangleBatch& batch);

}  // namespace relight
