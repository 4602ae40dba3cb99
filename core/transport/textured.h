#pragma once

#include <array>

#include "core/bsdf/material.h"
#include "core/trace/stage.h"

namespace relight {

/// What a file says of one place of its mesh.
struct FiledPlace {
    const MaterialMaps* maps = nullptr;  ///< of the place's group of faces; null: it has none
    std::array<Uv, 2> uvs{};             ///< of either set; (0, 0) where the mesh has none
    Rgb color = Rgb::grey(1.0);          ///< of the vertices, linear
    double bitangent_sign = 1.0;
};

/// Of a vertex: in the group of the first face that uses it.
FiledPlace filed_place(const Stage& stage, std::size_t vertex);
/// Of what a ray hit: interpolated. A point of a cloud is a vertex, in no group.
FiledPlace filed_place(const Stage& stage, const Hit& hit);

/// Vertex colour x base colour factor x base colour texture: what a request calls "vertex".
Rgb base_color(const Mesh& mesh, const FiledPlace& place);

/// The file's material as its textures and vertex colours make it at a place: each multiplies its
/// factor. The direction of the anisotropy's texture and its rotation are angles from the tangent
/// toward glTF's bitangent, which a mirrored picture has on the other side than the shading frame
/// has its y: there they count the other way round.   glTF 2.0, 3.9.2; KHR_materials_anisotropy
MetallicRoughness resolve(const MetallicRoughness& factors, const Mesh& mesh,
                          const FiledPlace& place);

/// Whether resolve() can say something else than the factors.
bool varies(const MetallicRoughness& factors, const Mesh& mesh, const FiledPlace& place);

/// Radiance along its normal that a triangle of the Surface sends out, averaged over its area: the
/// triangle as a light. The emissive texture (and a clear coat's) is looked up in the middles of
/// n^2 equal pieces of half a texel at most; where that would be too many (256^2, or 2^20 in all of
/// the mesh), at a random place in each of as many pieces as may be.
Rgb mean_emission(const Material& material, const Mesh& mesh, const Surface& surface,
                  std::size_t triangle);

}  // namespace relight
