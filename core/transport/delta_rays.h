#pragma once

#include <cstdint>
#include <span>

#include "core/geometry/vertex_fields.h"
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

/// Fills E[0 .. count) of the vertices from fields[first] on: of one unit of power, unoccluded; -0
/// where the light is below the horizon. With `rays` (empty before) puts into it for each of the
/// others, in their order, what arrive(), vertex_receiver() and shadow_ray() make of it, the same
/// to the last bit. False where vector code may not take these vertices: one is at the light, or so
/// far from it that squares lose bits.
/// @param per_unit Arrival's; nullptr: the light falls off by 1/d^2 alone, or is distant
bool light_up(const DeltaGeometry& light, const VertexFields& fields, std::size_t first,
              std::size_t count, const RayFields::Field<double>* per_unit,
              RayFields::Field<float>& E, ShadowStream* rays);

/// Bit i is 1 where E[i] is not negative, nor -0. What is, loses its sign.
std::uint64_t seen_word(std::span<float, 64> E);

}  // namespace relight
