#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/asset.h"
#include "core/base/result.h"

namespace relight {

struct GltfLimits {
    std::uint64_t vertices = 100'000'000,
                  faces = 200'000'000;   ///< of the scene, instances unfolded
    std::uint64_t pixels = 1ULL << 25U;  ///< of one texture
};

/// A glTF 2.0 asset, as JSON (.gltf, buffers and images in data URIs) or GLB, told by its first
/// bytes: the default scene (else the first, else every root node) in world coordinates, a vertex
/// for each vertex of each primitive of each node that shows it, in the order of a walk through the
/// scene, depth first. Mesh::pieces says which is which; lines and points keep their vertices and
/// add no faces. Morph targets and skins are at rest. Extensions: KHR_draco_mesh_compression,
/// EXT_meshopt_compression, KHR_mesh_quantization, EXT_mesh_gpu_instancing, KHR_texture_transform,
/// KHR_lights_punctual, the KHR_materials_* of MetallicRoughness; what else the file uses is passed
/// over and noted, unless it requires it.
/// Sandboxed only: Draco, meshoptimizer, image decoders and the JSON parser meet a client's bytes
/// here. Details name the place as a JSON pointer into the file.   Throws std::bad_alloc.
/// Errors: EmptyFile, MalformedHeader, MalformedBody, Truncated, JsonTooDeep, CountExceedsFile,
/// IndexOutOfRange, NonFiniteCoordinate, CoordinateTooLarge, NoGeometry, TooManyVertices,
/// TooManyFaces, OutOfRange, NotAvailable (an external file, a required extension).
Result<Asset> decode_gltf(std::span<const std::byte> file, const GltfLimits& limits);

}  // namespace relight
