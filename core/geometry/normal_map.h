#pragma once

#include <optional>

#include "core/base/vec.h"
#include "core/geometry/surface.h"

namespace relight {

/// The shading normal that a normal map makes of a smooth one at texture coordinate uv:
/// n' = x T + y B + z N with (x, y, z) of the texture, B = sign N x T. The smooth one where the
/// texture points nowhere.   glTF 2.0, 3.9.3
Dir3 bent_normal(Dir3 smooth, Dir3 tangent, double bitangent_sign, const Texture& texture,
                 const MaterialMaps& maps, Uv uv);

/// Bends the vertex normals of a surface by its mesh's normal maps, keeping the smooth ones in
/// `smooth_normals`; leaves a surface without such maps as it is.
void apply_normal_maps(const Mesh& mesh, Surface& surface);

}  // namespace relight
