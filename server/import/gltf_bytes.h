#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <vector>

#include "server/import/gltf_file.h"

namespace relight::gltf {

/// The little-endian number there, aligned or not; `at` must leave room for it.
template <class T>
T number_at(std::span<const std::byte> bytes, std::size_t at)
{
    assert(at + sizeof(T) <= bytes.size());
    T value;
    std::memcpy(&value, bytes.data() + at, sizeof(T));
    return value;
}

/// A file taken apart.
struct Container {
    bool is_glb = false;
    Json json;
    std::optional<std::span<const std::byte>> binary;  ///< a GLB's BIN chunk
};

/// Errors: EmptyFile, Truncated, MalformedHeader, JsonTooDeep.
Container open_container(std::span<const std::byte> file);

/// What EXT_meshopt_compression says of a view.
struct PackedShape {
    enum class Mode { Attributes, Triangles, Indices } mode{};
    enum class Filter { None, Octahedral, Quaternion, Exponential } filter{};
    std::uint64_t count = 0, stride = 0;
};

/// The extension's object, its mode, filter and stride held against each other.
PackedShape packed_shape(const Node& extension);

/// Refuses more elements than that many compressed bytes can stand for: so what unpack() allocates
/// is bounded by the file (64 to 1 at most).
void check_packed(const PackedShape& shape, std::size_t bytes, const Node& extension);

/// count * stride bytes, decoded by meshoptimizer and filtered.   Errors: MalformedBody.
std::vector<std::byte> unpack(const PackedShape& shape, std::span<const std::byte> bytes,
                              const Node& extension);

}  // namespace relight::gltf
