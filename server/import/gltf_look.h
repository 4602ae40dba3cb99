#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/asset.h"
#include "server/import/gltf_file.h"

namespace relight::gltf {

/// What the file's materials come to, before the scene is walked.
struct Look {
    std::vector<std::string> names;            ///< unique; one a material
    std::vector<MetallicRoughness> materials;  ///< factors
    std::vector<MaterialMaps> maps;            ///< one a material, or empty: no textures
    std::vector<Texture> textures;             ///< decoded
    std::vector<std::string> notes;            ///< what was passed over
};

/// All of /materials, with the textures they use decoded (PNG, JPEG; a picture that several
/// textures show, once).
Look read_look(File& file, std::uint64_t most_pixels);

/// KHR_lights_punctual's light `index` for the node at this place: `to_world` is the node's, row by
/// row (3 x 4). Point and spot in cd, directional in lx; the spot's cones by glTF's angles; looks
/// along the node's -Z.
Light read_light(const File& file, std::uint64_t index, std::string_view asked_at,
                 const std::array<double, 12>& to_world);

}  // namespace relight::gltf
