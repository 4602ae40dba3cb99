#pragma once

#include "core/trace/shadow_stream.h"

namespace relight {

/// The geometry of a delta light: where it is, or, `distant`, the way to it.
struct DeltaGeometry {
    bool distant = false;
    Point3 place;
    Vec3 wi;  ///< unit
    bool two_sided = false;
    double length_unit_m = 1.0;
    double reach = 0.0;  ///< of its shadows [scene units]; infinite is allowed
    UnitBox box;
    ClearanceRule clearance;
};

/// Some vertices under such a light, field by field.
struct alignas(64) DeltaBlock {
    static constexpr std::size_t capacity = ShadowStream::capacity;
    template <class T>
    using Field = RayFields::Field<T>;

    std::size_t count = 0;  ///< of vertices; what follows is filled that far
    Field<double> p_x, p_y, p_z, n_x, n_y, n_z, spacing;
    Field<double> per_unit;  ///< Arrival's; not asked of a light that falls off by 1/d^2 alone
    // Made of them:
    Field<float> E;      ///< unoccluded, of one unit of power
    Field<float> faces;  ///< 1 where the light is above the horizon, else 0
};

/// Whether vector code may take these vertices: none is at the light, or so far from it that
/// squares lose bits.
bool is_moderate(const DeltaGeometry& light, const DeltaBlock& block);

/// Fills E and faces, and with `rays` (empty before) puts into it for each vertex what arrive(),
/// vertex_receiver() and shadow_ray() make of it, the same to the last bit; for one that does not
/// face the light a ray to pass over. Returns how many there are to trace.
/// @param inverse_square E falls off by it alone: per_unit need not be filled
std::size_t light_up(const DeltaGeometry& light, bool inverse_square, DeltaBlock& block,
                     ShadowStream* rays);

}  // namespace relight
