#pragma once

#include <random>
#include <vector>

#include "core/display/display.h"
#include "core/io/writers.h"

namespace relight::test {

/// A mesh with much to lose: numbers with long fractions, tiny, huge and negative ones; triangles,
/// a quad and a pentagon that use every vertex; normals, colours of 8-bit codes. `vertices` of 8 or
/// more.
inline Mesh full_mesh(std::uint32_t vertices)
{
    std::mt19937 random(11);
    std::uniform_real_distribution<float> any(-1.0F, 1.0F);
    std::vector<float> awkward{0.1F, -0.0F, 1e-38F, 1e6F, 1.0F / 3.0F, 1e-45F, -16777216.0F, 3.0F};
    const auto number = [&] {
        if (awkward.empty()) { return any(random); }
        const float next = awkward.back();
        awkward.pop_back();
        return next;
    };
    Mesh mesh;
    mesh.format = "test";
    for (std::uint32_t i = 0; i < vertices; ++i) {
        mesh.positions.push_back({number(), number(), number()});
        mesh.normals.push_back({any(random), any(random), any(random)});
        mesh.uvs.push_back({any(random), any(random)});
        mesh.colors.push_back(to_float(srgb_eotf(
            Rgb8{static_cast<unsigned char>(i), 0, static_cast<unsigned char>(255 - i % 256)})));
    }
    for (std::uint32_t i = 0; i + 2 < vertices; ++i) {
        mesh.faces.offsets.push_back(3 * i);
        mesh.faces.indices.insert(mesh.faces.indices.end(), {i, i + 1, i + 2});
    }
    for (const std::vector<std::uint32_t>& face :
         std::vector<std::vector<std::uint32_t>>{{0, 1, 5, 4}, {4, 3, 2, 1, 0}}) {
        mesh.faces.offsets.push_back(static_cast<std::uint32_t>(mesh.faces.indices.size()));
        mesh.faces.indices.insert(mesh.faces.indices.end(), face.begin(), face.end());
    }
    mesh.faces.offsets.push_back(static_cast<std::uint32_t>(mesh.faces.indices.size()));
    return mesh;
}

/// Its triangles alone.
inline void drop_polygons(Mesh& mesh)
{
    mesh.faces.offsets.clear();
    mesh.faces.indices.resize(3 * (mesh.positions.size() - 2));
}

/// As floats: text keeps the decimals of a float, which are read as a double.
template <class T>
std::vector<Rgbf> floats(const std::vector<T>& values)
{
    std::vector<Rgbf> out;
    out.reserve(values.size());
    for (const T& v : values) { out.push_back(to_float(Rgb{v.x, v.y, v.z})); }
    return out;
}

}  // namespace relight::test
