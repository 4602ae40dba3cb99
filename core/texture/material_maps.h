#pragma once

#include <optional>

#include "core/texture/texture.h"

namespace relight {

/// Textures that vary a file's material over its surface (glTF 2.0 and its KHR extensions): each
/// multiplies the material's own factor, but for the normals.
struct MaterialMaps {
    Rgb base_color_factor = Rgb::grey(1.0);  ///< linear; with colours and texture it makes what a
                                             ///< request calls "vertex"
    std::optional<TextureMap> base_color;    ///< sRGB
    std::optional<TextureMap> metallic_roughness;   ///< G roughness, B metallic
    std::optional<TextureMap> emissive;             ///< sRGB
    std::optional<TextureMap> specular;             ///< A
    std::optional<TextureMap> specular_color;       ///< sRGB
    std::optional<TextureMap> clearcoat;            ///< R
    std::optional<TextureMap> clearcoat_roughness;  ///< G
    std::optional<TextureMap> sheen_color;          ///< sRGB
    std::optional<TextureMap> sheen_roughness;      ///< A
    std::optional<TextureMap> anisotropy;           ///< R G direction, B strength
    /// Tangent-space normals, R G B = (n + 1) / 2; n.xy is scaled. They are shape, not material:
    /// they stay when a request gives the surface another one.
    std::optional<TextureMap> normal;
    float normal_scale = 1.0F;

    bool any() const
    {
        return base_color || metallic_roughness || emissive || specular || specular_color ||
               clearcoat || clearcoat_roughness || sheen_color || sheen_roughness || anisotropy ||
               normal;
    }
};

}  // namespace relight
