#include "core/transport/textured.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/base/random.h"

namespace relight {
namespace {

using Weights = std::array<double, 3>;  // barycentric

Uv interpolated(const std::array<Uv, 3>& uv, const Weights& b)
{
    // As float it stays finite, whatever roundings add to the largest.
    constexpr double most = std::numeric_limits<float>::max();
    const auto along = [&](std::size_t axis) {
        double sum = 0.0;
        for (std::size_t k = 0; k < 3; ++k) { sum += static_cast<double>(uv[k][axis]) * b[k]; }
        return static_cast<float>(std::clamp(sum, -most, most));
    };
    return {along(0), along(1)};
}

/// Of the three corners; (0, 0) where the mesh has none.
std::array<Uv, 3> corners_of(const std::vector<Uv>& uvs, const Triangle& t)
{
    if (uvs.empty()) { return {}; }
    return {uvs[t[0]], uvs[t[1]], uvs[t[2]]};
}

const MaterialMaps* maps_of(const Mesh& mesh, const Surface& surface, std::size_t triangle)
{
    if (mesh.maps.empty() || mesh.face_materials.empty()) { return nullptr; }
    const std::size_t face =
        surface.triangle_face.empty() ? triangle : surface.triangle_face[triangle];
    return &mesh.maps[mesh.face_materials[face]];
}

TextureSample linear(const Mesh& mesh, const FiledPlace& place, const TextureMap& map)
{
    return sample_linear(mesh.textures[map.texture], map, place.uvs[map.uv_set]);
}

TextureSample linear(const Mesh& mesh, const FiledPlace& place,
                     const std::optional<TextureMap>& map)
{
    return map ? linear(mesh, place, *map) : TextureSample{Rgb::grey(1.0), 1.0};
}

Rgb srgb(const Mesh& mesh, const FiledPlace& place, const std::optional<TextureMap>& map)
{
    if (!map) { return Rgb::grey(1.0); }
    return sample_srgb(mesh.textures[map->texture], *map, place.uvs[map->uv_set]).rgb;
}

/// What emission() asks for.
void resolve_emission(MetallicRoughness& here, const Mesh& mesh, const FiledPlace& place)
{
    here.emissive = here.emissive * srgb(mesh, place, place.maps->emissive);
    here.clearcoat *= linear(mesh, place, place.maps->clearcoat).rgb.r;
}

/// The longer side of the box around a triangle of these coordinates, in texels.
double texels_across(const Texture& texture, const TextureMap& map, const std::array<Uv, 3>& uvs)
{
    const auto& m = map.transform;
    double across = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
        const Uv a = uvs[k], b = uvs[(k + 1) % 3];
        const double du = static_cast<double>(b[0]) - static_cast<double>(a[0]);
        const double dv = static_cast<double>(b[1]) - static_cast<double>(a[1]);
        const auto moved = [&](std::size_t row) {
            return std::abs(static_cast<double>(m[row]) * du +
                            static_cast<double>(m[row + 1]) * dv);
        };
        across = std::max({across, moved(0) * texture.width, moved(3) * texture.height});
    }
    return across;
}

}  // namespace

FiledPlace filed_place(const Stage& stage, std::size_t vertex)
{
    const Mesh& mesh = *stage.mesh;
    const Surface& surface = *stage.surface;
    FiledPlace place;
    if (!mesh.colors.empty()) { place.color = to_double(mesh.colors[vertex]); }
    if (surface.vertex_groups.empty() || surface.vertex_groups[vertex] == no_group) {
        return place;
    }
    place.maps = &mesh.maps[surface.vertex_groups[vertex]];
    if (!mesh.uvs.empty()) { place.uvs[0] = mesh.uvs[vertex]; }
    if (!mesh.uvs_1.empty()) { place.uvs[1] = mesh.uvs_1[vertex]; }
    if (!surface.tangents.empty() && surface.tangents[vertex][3] < 0.0F) {
        place.bitangent_sign = -1.0;
    }
    return place;
}

FiledPlace filed_place(const Stage& stage, const Hit& hit)
{
    const Mesh& mesh = *stage.mesh;
    const Surface& surface = *stage.surface;
    if (hit.is_point) { return filed_place(stage, std::size_t{hit.primitive}); }
    const Triangle& t = surface.triangles[hit.primitive];
    const Weights b{1.0 - hit.u - hit.v, hit.u, hit.v};
    FiledPlace place;
    if (!mesh.colors.empty()) {
        place.color = to_double(mesh.colors[t[0]]) * b[0] + to_double(mesh.colors[t[1]]) * b[1] +
                      to_double(mesh.colors[t[2]]) * b[2];
    }
    place.maps = maps_of(mesh, surface, hit.primitive);
    if (place.maps == nullptr) { return place; }
    place.uvs = {interpolated(corners_of(mesh.uvs, t), b),
                 interpolated(corners_of(mesh.uvs_1, t), b)};
    if (!surface.tangents.empty()) {
        double sign = 0.0;
        for (std::size_t k = 0; k < 3; ++k) {
            sign += static_cast<double>(surface.tangents[t[k]][3]) * b[k];
        }
        place.bitangent_sign = sign < 0.0 ? -1.0 : 1.0;
    }
    return place;
}

Rgb base_color(const Mesh& mesh, const FiledPlace& place)
{
    if (place.maps == nullptr) { return place.color; }
    return place.color * place.maps->base_color_factor * srgb(mesh, place, place.maps->base_color);
}

MetallicRoughness resolve(const MetallicRoughness& factors, const Mesh& mesh,
                          const FiledPlace& place)
{
    MetallicRoughness here = factors;
    here.base_color = here.base_color * place.color;
    if (place.maps == nullptr) { return here; }
    const MaterialMaps& maps = *place.maps;
    here.base_color = here.base_color * srgb(mesh, place, maps.base_color);
    const Rgb metallic_roughness = linear(mesh, place, maps.metallic_roughness).rgb;
    here.roughness *= metallic_roughness.g;
    here.metallic *= metallic_roughness.b;
    here.specular *= linear(mesh, place, maps.specular).alpha;
    here.specular_color = here.specular_color * srgb(mesh, place, maps.specular_color);
    here.clearcoat_roughness *= linear(mesh, place, maps.clearcoat_roughness).rgb.g;
    here.sheen_color = here.sheen_color * srgb(mesh, place, maps.sheen_color);
    here.sheen_roughness *= linear(mesh, place, maps.sheen_roughness).alpha;
    if (maps.anisotropy) {
        const Rgb anisotropy = linear(mesh, place, *maps.anisotropy).rgb;
        here.anisotropy_rotation += std::atan2(2.0 * anisotropy.g - 1.0, 2.0 * anisotropy.r - 1.0);
        here.anisotropy_strength *= anisotropy.b;
    }
    here.anisotropy_rotation *= place.bitangent_sign;
    resolve_emission(here, mesh, place);
    return here;
}

bool varies(const MetallicRoughness& factors, const Mesh& mesh, const FiledPlace& place)
{
    return !mesh.colors.empty() ||
           (place.maps != nullptr && (place.maps->any() || factors.anisotropy_strength > 0.0));
}

Rgb mean_emission(const Material& material, const Mesh& mesh, const Surface& surface,
                  std::size_t triangle)
{
    const MaterialMaps* maps = maps_of(mesh, surface, triangle);
    const Rgb everywhere = emission(material);
    if (everywhere == Rgb{} || maps == nullptr || !(maps->emissive || maps->clearcoat)) {
        return everywhere;
    }
    const auto& factors = std::get<MetallicRoughness>(material);  // no other model shines
    const Triangle& t = surface.triangles[triangle];
    const std::array<std::array<Uv, 3>, 2> uvs{corners_of(mesh.uvs, t), corners_of(mesh.uvs_1, t)};
    constexpr double least = 2.0;  // pieces of an edge
    constexpr double look_ups = 0x1p20;
    const auto triangles = static_cast<double>(surface.triangles.size());
    const double most = std::clamp(std::floor(std::sqrt(look_ups / triangles)), least, 256.0);
    double wanted = least;
    for (const auto& map : {maps->emissive, maps->clearcoat}) {
        if (!map) { continue; }
        const Texture& texture = mesh.textures[map->texture];
        wanted = std::max(wanted, std::ceil(2.0 * texels_across(texture, *map, uvs[map->uv_set])));
    }
    const bool all = wanted <= most;
    const auto n = static_cast<int>(all ? wanted : most);
    FiledPlace place{maps, {}, {}, 1.0};
    Rgb sum;
    std::uint64_t piece = 0;
    const auto look = [&](int i, int j, bool upright) {
        double u = 1.0 / 3.0, v = 1.0 / 3.0;
        if (!all) {
            u = uniform(triangle, piece, 0, 0);
            v = uniform(triangle, piece, 0, 1);
            if (u + v > 1.0) { u = 1.0 - u, v = 1.0 - v; }
        }
        ++piece;
        const double b1 = (i + (upright ? u : 1.0 - u)) / n;
        const double b2 = (j + (upright ? v : 1.0 - v)) / n;
        for (std::size_t set = 0; set < 2; ++set) {
            place.uvs[set] = interpolated(uvs[set], {1.0 - b1 - b2, b1, b2});
        }
        MetallicRoughness here = factors;
        resolve_emission(here, mesh, place);
        sum += emission(here, 1.0);
    };
    for (int i = 0; i < n; ++i) {
        for (int j = 0; i + j < n; ++j) {
            look(i, j, true);
            if (i + j + 1 < n) { look(i, j, false); }
        }
    }
    return sum / (static_cast<double>(n) * n);
}

}  // namespace relight
