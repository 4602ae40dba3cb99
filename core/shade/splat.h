#pragma once

#include "core/base/rgb.h"
#include "core/trace/stage.h"

namespace relight {

/// A place on the surface that a cloud's discs stand for.
struct Splat {
    Point3 p;  ///< on the ray
    Dir3 n;    ///< toward the viewer if the front is seen, else away
    Rgb color;
    double spacing{};  ///< of the points around, scene units
};

/// Where a ray met a cloud: the mean of the discs that overlap there and face the same way, so that
/// none of their rims shows. A disc of radius R whose plane the ray passes at r from its centre
/// counts (1 - r^2/R^2)^2, which ends smoothly at the rim, and less the deeper it lies behind the
/// one that was met, nothing from R on.
///
/// The back of a disc that a neighbour's front may hide (Surface::bend) is a rim that stands out
/// over the silhouette: it passes for the front. The back of a sheet stays its back.
Splat splat_at(const Stage& stage, Point3 origin, Dir3 direction, const Hit& hit);

}  // namespace relight
