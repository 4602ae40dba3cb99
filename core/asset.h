#pragma once

#include <vector>

#include "core/bsdf/metallic_roughness.h"
#include "core/geometry/mesh.h"
#include "core/light/light.h"

namespace relight {

/// All that a client's file brings: the geometry, and what some formats say beside it.
struct Asset {
    Mesh mesh;
    /// Factors, one each of mesh.materials (whose textures are mesh.maps); empty: the format has no
    /// materials of ours.
    std::vector<MetallicRoughness> materials;
    std::vector<Light> lights;  ///< photometric [cd], [lx]; in the mesh's frame
};

}  // namespace relight
