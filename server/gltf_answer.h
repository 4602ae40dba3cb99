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
/// vertex belongs. The importer accepted the file before: nothing here decodes what it compressed.
/// `file`, and what the Encodings of core/io need, must outlive the answer.
/// Errors: Internal (the file is not the one that the mesh came from), NotAvailable (instances
/// whose transforms are compressed or sparse; copies of meshes beyond 16 MiB of JSON, 250000
/// accessors; 4 GiB, the most that a GLB holds).
Result<Encoding> add_to_gltf(std::span<const std::byte> file, const LitMesh& lit);

}  // namespace relight
