#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/rgb.h"

namespace relight {

/// A decoded picture to be laid on a surface: 8-bit codes as filed, row 0 on top.
struct Texture {
    int width = 0, height = 0;
    std::vector<std::array<std::uint8_t, 4>> texels;  ///< width * height: R G B A
};

/// What lies beyond the picture's edges.
enum class Wrap : std::uint8_t { Repeat, ClampToEdge, MirroredRepeat };

/// Texture coordinates: (0, 0) is the upper left corner of the picture, as in glTF.
using Uv = std::array<float, 2>;

/// How a texture lies on a surface.
struct TextureMap {
    std::uint32_t texture = 0;  ///< into Mesh::textures
    std::uint8_t uv_set = 0;    ///< 0: Mesh::uvs, 1: Mesh::uvs_1
    Wrap wrap_u = Wrap::Repeat, wrap_v = Wrap::Repeat;
    bool nearest = false;  ///< no interpolation between texels
    /// u' = m0 u + m1 v + m2, v' = m3 u + m4 v + m5 (KHR_texture_transform).
    std::array<float, 6> transform{1.0F, 0.0F, 0.0F, 0.0F, 1.0F, 0.0F};
};

/// What the texture shows there, [0, 1] a channel; bilinear between texel centres unless the map
/// says nearest. No smaller copies of the picture: a vertex is a point. Finite for any finite uv.
struct TextureSample {
    Rgb rgb;
    double alpha = 1.0;
};

/// The codes / 255, for data: roughness, normals.
TextureSample sample_linear(const Texture& texture, const TextureMap& map, Uv uv);

/// Colour: each texel's R G B is sRGB-decoded before it is mixed; alpha is linear.
TextureSample sample_srgb(const Texture& texture, const TextureMap& map, Uv uv);

}  // namespace relight
