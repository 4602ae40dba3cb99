#pragma once

#include "core/transport/receiver.h"

namespace relight {

/// A place that a ray met, ready to be lit: normals interpolated, on the side that the ray came
/// from.
struct Seen {
    Receiver at;
    Vec3 wo;  ///< back along the ray, in at.frame; wo.z > 0
    LocalMaterial material;
    Rgb color;          ///< the file's, interpolated
    bool front = true;  ///< the side that the normals are on

    /// false: the place has no side to be lit, and the rest says nothing.
    bool is_there() const { return static_cast<bool>(at.ng); }
};

/// What a ray along `direction` met.
Seen see(const Stage& stage, const Scene& scene, Point3 origin, Dir3 direction, const Hit& hit);

/// Whether light along wi can reach the place: from above both its shading normal and its face. Of
/// a coarse mesh that stands for a round one (Terminator::Smooth) the face does not count where
/// rays start well above it: they then find out.
bool is_above(const Seen& seen, Dir3 wi);

}  // namespace relight
