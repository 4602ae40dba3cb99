#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "core/base/result.h"
#include "core/io/writers.h"

namespace relight {

/// The glTF or GLB that a mesh came as, as GLB, with what was computed added to each primitive:
/// COLOR_0 (linear float, in place of one that was there), _IRRADIANCE and so on. Everything else
/// stays: nodes, materials, textures, lights, cameras, animations, unknown extensions and extras. A
/// mesh that several nodes show is copied for each (its accessors are shared), for each is lit
/// otherwise; instances of EXT_mesh_gpu_instancing become nodes. `lit.mesh.pieces` says where each
/// vertex belongs.   Error Internal if the file is not the one that the mesh came from.
Result<std::string> add_to_gltf(std::span<const std::byte> file, const LitMesh& lit);

}  // namespace relight
