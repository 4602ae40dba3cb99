#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "core/base/random.h"
#include "core/geometry/mesh.h"
#include "tests/shapes.h"

namespace relight::test {

using Code = std::array<std::uint8_t, 4>;

inline Texture plain(Code code)
{
    return {1, 1, {code}};
}

/// Texels of random codes.
inline Texture patches(int width, int height, std::uint64_t seed)
{
    Texture texture{width, height, {}};
    for (std::uint64_t i = 0; i < static_cast<std::uint64_t>(width) * static_cast<unsigned>(height);
         ++i) {
        Code code{};
        for (std::uint64_t band = 0; band < 4; ++band) {
            code[band] = static_cast<std::uint8_t>(256.0 * uniform(seed, i, 0, band));
        }
        texture.texels.push_back(code);
    }
    return texture;
}

inline void expect_near(Rgb value, Rgb expected, Rgb tolerance)
{
    EXPECT_NEAR(value.r, expected.r, tolerance.r);
    EXPECT_NEAR(value.g, expected.g, tolerance.g);
    EXPECT_NEAR(value.b, expected.b, tolerance.b);
}
inline void expect_near(Rgb value, Rgb expected, double tolerance)
{
    expect_near(value, expected, Rgb::grey(tolerance));
}

/// Linear light of an sRGB code (IEC 61966-2-1).
inline double decoded(std::uint8_t code)
{
    const double c = code / 255.0;
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}
inline Rgb decoded(Code code)
{
    return {decoded(code[0]), decoded(code[1]), decoded(code[2])};
}

/// The square [-1, 1]^2 of n x n quads facing +z, with a picture on it whose top is at y = 1; one
/// group, without maps yet.
inline Mesh pictured_grid(int n)
{
    Mesh mesh = grid(n);
    for (const Point3 p : mesh.positions) {
        mesh.uvs.push_back(
            {static_cast<float>(0.5 + 0.5 * p.x), static_cast<float>(0.5 - 0.5 * p.y)});
    }
    mesh.materials = {"pictured"};
    mesh.face_materials.assign(mesh.faces.count(), 0);
    mesh.maps.resize(1);
    return mesh;
}

/// Lays a texture on the mesh and gives the map that names it.
inline TextureMap lay(Mesh& mesh, Texture texture, bool nearest = false)
{
    mesh.textures.push_back(std::move(texture));
    TextureMap map;
    map.texture = static_cast<std::uint32_t>(mesh.textures.size() - 1);
    map.wrap_u = map.wrap_v = Wrap::ClampToEdge;
    map.nearest = nearest;
    return map;
}

}  // namespace relight::test
