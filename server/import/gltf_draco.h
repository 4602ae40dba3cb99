#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "server/import/gltf_accessor.h"

namespace relight::gltf {

/// What KHR_draco_mesh_compression unpacks to, in the order of the decoder.
struct DracoMesh {
    struct Attribute {
        Component component{};
        std::size_t width = 0;         ///< numbers a vertex
        std::vector<std::byte> bytes;  ///< tight
    };
    std::vector<std::uint32_t> indices;           ///< three a face, below the number of vertices
    std::map<std::string, Attribute> attributes;  ///< by glTF's name
};

/// The mesh of a primitive's extension object. That it has as many vertices and faces as the
/// primitive's accessors say is checked before any of it is copied.   Errors: MalformedBody.
DracoMesh unpack_draco(File& file, const Node& extension, std::uint64_t vertices,
                       std::uint64_t faces);

}  // namespace relight::gltf
