#include "server/import/promises.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace relight {
namespace {

/// `test` holds of every element. Without a way out in the middle: good arrays are the rule, and so
/// the loop can be one of vector instructions.
template <class Values, class Test>
bool all(const Values& values, const Test& test)
{
    bool good = true;
    for (const auto& value : values) { good = good & test(value); }
    return good;
}

constexpr auto finite = [](const auto& value) { return is_finite(value); };
constexpr auto finite_floats = [](const auto& floats) {
    return all(floats, [](float v) { return is_finite(double{v}); });
};

bool in(double value, double low, double high)
{
    return value >= low && value <= high;  // false for NaN
}

bool in(Rgb value, double low, double high)
{
    return in(value.r, low, high) && in(value.g, low, high) && in(value.b, low, high);
}

bool is_place(Point3 p)
{
    constexpr double most = largest_coordinate;
    return std::abs(p.x) <= most && std::abs(p.y) <= most && std::abs(p.z) <= most;
}

bool good_faces(const Faces& faces, std::size_t vertices)
{
    if (!all(faces.indices, [&](std::uint32_t v) { return v < vertices; })) { return false; }
    const auto& offsets = faces.offsets;
    if (offsets.empty()) { return faces.indices.size() % 3 == 0; }
    return offsets.front() == 0 && offsets.back() == faces.indices.size() &&
           std::is_sorted(offsets.begin(), offsets.end());
}

/// Strictly ascending.
bool good_absent(const std::vector<std::uint32_t>& absent, std::size_t vertices)
{
    return std::adjacent_find(absent.begin(), absent.end(), std::greater_equal<>()) ==
               absent.end() &&
           (absent.empty() || absent.back() < vertices);
}

bool good_pieces(const std::vector<GltfPiece>& pieces, std::size_t vertices)
{
    std::uint64_t next = 0;
    for (const GltfPiece& piece : pieces) {
        if (piece.first_vertex != next) { return false; }
        next += piece.vertices;
    }
    return pieces.empty() || next == vertices;
}

bool good_texture(const Texture& texture)
{
    return texture.width > 0 && texture.height > 0 &&
           texture.texels.size() == static_cast<std::uint64_t>(texture.width) *
                                        static_cast<std::uint64_t>(texture.height);
}

bool good_maps(const MaterialMaps& maps, std::size_t textures)
{
    const auto good = [&](const std::optional<TextureMap>& map) {
        return !map ||
               (map->texture < textures && map->uv_set <= 1 && finite_floats(map->transform));
    };
    return in(maps.base_color_factor, 0.0, 1.0) && is_finite(double{maps.normal_scale}) &&
           good(maps.base_color) && good(maps.metallic_roughness) && good(maps.emissive) &&
           good(maps.specular) && good(maps.specular_color) && good(maps.clearcoat) &&
           good(maps.clearcoat_roughness) && good(maps.sheen_color) && good(maps.sheen_roughness) &&
           good(maps.anisotropy) && good(maps.normal);
}

bool good_mesh(const Mesh& mesh)
{
    const std::size_t V = mesh.positions.size(), F = mesh.faces.count();
    const auto fits = [](const auto& array, std::size_t length) {
        return array.empty() || array.size() == length;
    };
    return fits(mesh.normals, V) && fits(mesh.colors, V) && fits(mesh.uvs, V) &&
           fits(mesh.uvs_1, V) && fits(mesh.tangents, V) &&
           fits(mesh.corner_uvs, mesh.faces.indices.size()) &&
           fits(mesh.maps, mesh.materials.size()) && fits(mesh.face_materials, F) &&
           all(mesh.positions, is_place) && good_faces(mesh.faces, V) &&
           good_absent(mesh.absent, V) && (mesh.absent.empty() || F == 0) &&
           all(mesh.normals, finite) && all(mesh.colors, finite_floats) &&
           all(mesh.uvs, finite_floats) && all(mesh.uvs_1, finite_floats) &&
           all(mesh.corner_uvs, finite_floats) && all(mesh.tangents, finite_floats) &&
           all(mesh.face_materials, [&](std::uint32_t m) { return m < mesh.materials.size(); }) &&
           all(mesh.textures, good_texture) &&
           all(mesh.maps,
               [&](const MaterialMaps& maps) { return good_maps(maps, mesh.textures.size()); }) &&
           (!mesh.viewpoint || is_place(*mesh.viewpoint)) && good_pieces(mesh.pieces, V);
}

/// Where nothing else bounds a number: as a power in a request (server/light_json.cpp).
constexpr double largest_factor = 1e12;

bool good_material(const MetallicRoughness& m)
{
    constexpr double turn = 2.0 * std::numbers::pi;
    return in(m.base_color, 0.0, 1.0) && in(m.metallic, 0.0, 1.0) && in(m.roughness, 0.0, 1.0) &&
           (m.ior == 0.0 || in(m.ior, 1.0, largest_factor)) && in(m.specular, 0.0, 1.0) &&
           in(m.specular_color, 0.0, largest_factor) && in(m.clearcoat, 0.0, 1.0) &&
           in(m.clearcoat_roughness, 0.0, 1.0) && in(m.sheen_color, 0.0, 1.0) &&
           in(m.sheen_roughness, 0.0, 1.0) && in(m.anisotropy_strength, 0.0, 1.0) &&
           in(m.anisotropy_rotation, -turn, turn) && in(m.emissive, 0.0, 1.0) &&
           in(m.emissive_strength, 0.0, largest_factor);
}

bool good_range(std::optional<double> range)
{
    return !range || (*range > 0.0 && is_finite(*range));
}

/// Directions need no look: whoever reads one makes it unit.
struct GoodShape {
    bool operator()(const PointLight& light) const
    {
        return is_place(light.position) && good_range(light.range);
    }
    bool operator()(const SpotLight& light) const
    {
        return is_place(light.position) && good_range(light.range) && light.inner_cone >= 0.0 &&
               light.inner_cone < light.outer_cone && light.outer_cone <= 0.5 * std::numbers::pi;
    }
    bool operator()(const DirectionalLight& light) const
    {
        return in(light.half_angle, 0.0, 0.5 * std::numbers::pi);
    }
    template <class Other>
    bool operator()(const Other& /*light*/) const
    {
        return false;
    }
};

bool good_light(const Light& light)
{
    return in(light.power, 0.0, largest_factor) && std::visit(GoodShape{}, light.shape);
}

}  // namespace

bool keeps_promises(const Asset& asset)
{
    return good_mesh(asset.mesh) && all(asset.materials, good_material) &&
           all(asset.lights, good_light) &&
           (asset.materials.empty() || asset.materials.size() == asset.mesh.materials.size());
}

}  // namespace relight
