#pragma once

#include "core/base/vec.h"
#include "core/geometry/surface.h"

namespace relight {

/// The shading normal that the maps' normal map makes of a smooth one at texture coordinate uv:
/// n' = x T + y B + z N with (x, y, z) of the texture, B = sign N x T. The smooth one where the
/// texture points nowhere or the tangent is none. Never below the smooth normal's horizon: z is at
/// least 0.01 of the whole.   glTF 2.0, 3.9.3
Dir3 bent_normal(Dir3 smooth, Vec3 tangent, double bitangent_sign, const Texture& texture,
                 const MaterialMaps& maps, Uv uv);

/// Bends the vertex normals of a surface by its mesh's normal maps, keeping the smooth ones in
/// `smooth_normals`; leaves a surface without such maps as it is. A vertex has the map of its group
/// (Surface::vertex_groups); without a tangent it stays smooth.
void apply_normal_maps(const Mesh& mesh, unsigned threads, Progress& progress, Surface& surface);

}  // namespace relight
