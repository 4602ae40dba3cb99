#pragma once

#include <cstdint>
#include <span>

#include "core/geometry/surface.h"
#include "core/preview/draw.h"

namespace relight {

/// At most 200,000 of the points [0, count), in order, one from each of so many equal runs: a
/// software driver takes seconds for a million.
std::vector<std::uint32_t> chosen_points(std::size_t count);

/// A point of a cloud as it is drawn, in the drawing's coordinates.
struct DrawnPoint {
    Point3 p;
    Dir3 n;           ///< "no direction": it faces the eye
    double bend{};    ///< Surface::bend
    double radius{};  ///< of the disc that it stands for
    Rgb8 color;
};

/// Adds the point as a flat cone of six triangles, its tip toward the eye: where neighbours
/// overlap, each is in front around its own tip, so that the colours part half-way between the
/// points and the discs' rims stay hidden. No smaller than a pixel and a half across. Not the back
/// of one that a neighbour's front may hide: its rim would stand out over the silhouette.
void add_disc(const DrawnPoint& point, Drawing& drawing);

}  // namespace relight
