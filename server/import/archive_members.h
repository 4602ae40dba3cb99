#pragma once

#include <concepts>
#include <tuple>
#include <type_traits>

#include "core/asset.h"

namespace relight::archive {

// The one description of what travels, for both directions: all the members of each struct, in
// order. (A structured binding names them all: a new member does not compile until it travels too.)

template <class T, class U>
concept Of = std::same_as<std::remove_const_t<T>, U>;

auto members(Of<Asset> auto& asset)
{
    auto& [mesh, materials, lights] = asset;
    return std::tie(mesh, materials, lights);
}

auto members(Of<Mesh> auto& mesh)
{
    auto& [format, positions, absent, double_positions, faces, normals, colors, uvs, uvs_1,
           corner_uvs, tangents, materials, maps, textures, face_materials, viewpoint, pieces,
           notes] = mesh;
    return std::tie(format, positions, absent, double_positions, faces, normals, colors, uvs, uvs_1,
                    corner_uvs, tangents, materials, maps, textures, face_materials, viewpoint,
                    pieces, notes);
}

auto members(Of<Faces> auto& faces)
{
    auto& [indices, offsets] = faces;
    return std::tie(indices, offsets);
}

auto members(Of<Texture> auto& texture)
{
    auto& [width, height, texels] = texture;
    return std::tie(width, height, texels);
}

auto members(Of<TextureMap> auto& map)
{
    auto& [texture, uv_set, wrap_u, wrap_v, nearest, transform] = map;
    return std::tie(texture, uv_set, wrap_u, wrap_v, nearest, transform);
}

auto members(Of<MaterialMaps> auto& maps)
{
    auto& [base_color_factor, base_color, metallic_roughness, emissive, specular, specular_color,
           clearcoat, clearcoat_roughness, sheen_color, sheen_roughness, anisotropy, normal,
           normal_scale] = maps;
    return std::tie(base_color_factor, base_color, metallic_roughness, emissive, specular,
                    specular_color, clearcoat, clearcoat_roughness, sheen_color, sheen_roughness,
                    anisotropy, normal, normal_scale);
}

auto members(Of<MetallicRoughness> auto& material)
{
    auto& [base_color, base_color_from_vertex, metallic, roughness, ior, specular, specular_color,
           clearcoat, clearcoat_roughness, sheen_color, sheen_roughness, anisotropy_strength,
           anisotropy_rotation, emissive, emissive_strength] = material;
    return std::tie(base_color, base_color_from_vertex, metallic, roughness, ior, specular,
                    specular_color, clearcoat, clearcoat_roughness, sheen_color, sheen_roughness,
                    anisotropy_strength, anisotropy_rotation, emissive, emissive_strength);
}

auto members(Of<Light> auto& light)
{
    auto& [name, shape, power, enabled, cast_shadows] = light;
    return std::tie(name, shape, power, enabled, cast_shadows);
}

auto members(Of<PointLight> auto& light)
{
    auto& [position, range] = light;
    return std::tie(position, range);
}

auto members(Of<SpotLight> auto& light)
{
    auto& [position, axis, inner_cone, outer_cone, range] = light;
    return std::tie(position, axis, inner_cone, outer_cone, range);
}

auto members(Of<DirectionalLight> auto& light)
{
    auto& [travel, half_angle] = light;
    return std::tie(travel, half_angle);
}

template <class T>
concept Described = requires(T& value)
{
    members(value);
};

}  // namespace relight::archive
