#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "core/asset.h"
#include "server/import/archive.h"

namespace relight::test {

inline TextureMap texture_map(std::uint32_t texture)
{
    const float t = static_cast<float>(texture);
    return {.texture = texture,
            .uv_set = static_cast<std::uint8_t>(texture % 2),
            .wrap_u = static_cast<Wrap>(texture % 3),
            .wrap_v = static_cast<Wrap>((texture + 1) % 3),
            .nearest = texture % 2 == 0,
            .transform = {t, t + 0.1F, t + 0.2F, t + 0.3F, t + 0.4F, t + 0.5F}};
}

/// A mesh of glTF with something in every member, all of them told apart by their values.
inline Asset full_asset()
{
    Asset asset;
    Mesh& m = asset.mesh;
    m.format = "glb";
    m.positions = {{0, 1, 2}, {3, 4, 5}, {6, 7, -1e15}, {9, 10, 11}, {12, 13, 14}};
    m.double_positions = true;
    m.faces = {{0, 1, 2, 2, 3, 4, 0}, {0, 3, 7}};
    m.normals = {{0, 0, 1}, {0, 1, 0}, {}, {0, 0, -3}, {5, 0, 0}};
    m.colors = {{0.1F, 0.2F, 0.3F}, {}, {1, 1, 1}, {2, 0, 0}, {0, 0, 4}};
    m.uvs = {{0, 0}, {0, 1}, {-3, 0.5F}, {7, 7}, {0.25F, 0.75F}};
    m.uvs_1 = {{1, 1}, {1, 2}, {1, 3}, {1, 4}, {1, 5}};
    m.corner_uvs = {{2, 1}, {2, 2}, {2, 3}, {2, 4}, {2, 5}, {2, 6}, {2, 7}};
    m.tangents = {{1, 0, 0, 1}, {0, 1, 0, -1}, {}, {0, 0, 1, 1}, {0, 0, 1, -1}};
    m.materials = {"brick", "Gr\u00fcn"};
    for (std::uint32_t i = 0; i < 11; ++i) {
        m.textures.push_back({1, static_cast<int>(i) + 1, {}});
        for (std::uint32_t row = 0; row <= i; ++row) {
            m.textures.back().texels.push_back({static_cast<std::uint8_t>(i), 7, 255, 1});
        }
    }
    m.maps.resize(2);
    m.maps[0] = {{0.1, 0.2, 0.3}, texture_map(0),  texture_map(1), texture_map(2), texture_map(3),
                 texture_map(4),  texture_map(5),  texture_map(6), texture_map(7), texture_map(8),
                 texture_map(9),  texture_map(10), -0.5F};
    m.maps[1].emissive = texture_map(3);
    m.face_materials = {1, 0};
    m.viewpoint = Point3{1, 2, 3};
    m.pieces = {{8, 1, 0, 0, 3}, {9, 0, 4, 3, 2}};
    m.notes = {"two animations are left out", ""};
    asset.materials = {{.base_color = {0.11, 0.12, 0.13},
                        .base_color_from_vertex = true,
                        .metallic = 0.2,
                        .roughness = 0.3,
                        .ior = 1.4,
                        .specular = 0.5,
                        .specular_color = {1.6, 0.61, 0.62},
                        .clearcoat = 0.7,
                        .clearcoat_roughness = 0.8,
                        .sheen_color = {0.9, 0.91, 0.92},
                        .sheen_roughness = 0.15,
                        .anisotropy_strength = 0.16,
                        .anisotropy_rotation = -0.17,
                        .emissive = {0.18, 0.19, 0.195},
                        .emissive_strength = 1000.0},
                       {}};
    const Dir3 down = normalize({0, -2, 0}), aslant = normalize({1, 2, 3});
    asset.lights = {
        {"bulb", PointLight{{1, 2, 3}, 4.5}, {5, 6, 7}, true, false},
        {"lamp", PointLight{{4, 5, 6}, {}}, {8, 9, 10}, false, true},
        {"spot", SpotLight{{7, 8, 9}, aslant, 0.25, 0.5, 7.5}, {11, 12, 13}, true, true},
        {"sun", DirectionalLight{down, 0.004}, {14, 15, 16}, false, false}};
    return asset;
}

/// A cloud with a place of which nothing is known.
inline Asset cloud_asset()
{
    Asset asset;
    asset.mesh.format = "glb";
    asset.mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}};
    asset.mesh.absent = {0, 2};
    return asset;
}

inline std::string archive_of(const Asset& asset)
{
    std::string bytes;
    write_asset(asset, [&](std::span<const std::byte> some) {
        bytes.append(reinterpret_cast<const char*>(some.data()), some.size());
        return true;
    });
    return bytes;
}

struct BrokenPromise {
    std::string what;
    Asset asset;
};

/// Assets that break one promise each.
inline std::vector<BrokenPromise> broken_promises()
{
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    constexpr double infinite = std::numeric_limits<double>::infinity();
    constexpr float nan_f = std::numeric_limits<float>::quiet_NaN();
    constexpr double right_angle = 0.5 * std::numbers::pi;
    std::vector<BrokenPromise> broken;
    const auto full = [&](const char* what, const std::function<void(Asset&, Mesh&)>& change) {
        broken.push_back({what, full_asset()});
        change(broken.back().asset, broken.back().asset.mesh);
    };
    const auto cloud = [&](const char* what, const std::function<void(Mesh&)>& change) {
        broken.push_back({what, cloud_asset()});
        change(broken.back().asset.mesh);
    };
    full("position NaN", [&](Asset&, Mesh& m) { m.positions[1].y = nan; });
    full("position infinite", [&](Asset&, Mesh& m) { m.positions[4].z = -infinite; });
    full("position too far", [&](Asset&, Mesh& m) { m.positions[0].x = 1.001e15; });
    full("index V", [&](Asset&, Mesh& m) { m.faces.indices[6] = 5; });
    full("index of no vertex", [&](Asset&, Mesh& m) { m.faces.indices[0] = ~0U; });
    full("offsets start late", [&](Asset&, Mesh& m) { m.faces.offsets[0] = 1; });
    full("offsets fall", [&](Asset&, Mesh& m) { m.faces.offsets[1] = 8; });
    full("offsets end early", [&](Asset&, Mesh& m) { m.faces.offsets[2] = 6; });
    full("offsets end late", [&](Asset&, Mesh& m) { m.faces.offsets[2] = 8; });
    full("corners left over", [&](Asset& a, Mesh& m) {
        m.faces.offsets.clear();
        m.face_materials.clear();
        a.materials.clear();
    });
    full("normals short", [&](Asset&, Mesh& m) { m.normals.pop_back(); });
    full("colours long", [&](Asset&, Mesh& m) { m.colors.emplace_back(); });
    full("uvs short", [&](Asset&, Mesh& m) { m.uvs.pop_back(); });
    full("uvs_1 short", [&](Asset&, Mesh& m) { m.uvs_1.pop_back(); });
    full("corner_uvs short", [&](Asset&, Mesh& m) { m.corner_uvs.pop_back(); });
    full("tangents short", [&](Asset&, Mesh& m) { m.tangents.pop_back(); });
    full("normal NaN", [&](Asset&, Mesh& m) { m.normals[2].z = nan; });
    full("colour NaN", [&](Asset&, Mesh& m) { m.colors[2][1] = nan_f; });
    full("uv infinite", [&](Asset&, Mesh& m) { m.uvs[4][1] = -HUGE_VALF; });
    full("uv_1 NaN", [&](Asset&, Mesh& m) { m.uvs_1[0][0] = nan_f; });
    full("corner uv NaN", [&](Asset&, Mesh& m) { m.corner_uvs[6][0] = nan_f; });
    full("tangent NaN", [&](Asset&, Mesh& m) { m.tangents[3][3] = nan_f; });
    full("maps short", [&](Asset&, Mesh& m) { m.maps.pop_back(); });
    full("no such texture", [&](Asset&, Mesh& m) { m.maps[0].normal->texture = 11; });
    full("no such texture in the last", [&](Asset&, Mesh& m) { m.maps[1].emissive->texture = 11; });
    full("uv set 2", [&](Asset&, Mesh& m) { m.maps[0].sheen_color->uv_set = 2; });
    full("wrap 3", [&](Asset&, Mesh& m) { m.maps[0].specular->wrap_v = static_cast<Wrap>(3); });
    full("transform NaN", [&](Asset&, Mesh& m) { m.maps[0].clearcoat->transform[5] = nan_f; });
    full("factor -1", [&](Asset&, Mesh& m) { m.maps[0].base_color_factor.g = -1.0; });
    full("factor 2", [&](Asset&, Mesh& m) { m.maps[0].base_color_factor.b = 2.0; });
    full("normal scale NaN", [&](Asset&, Mesh& m) { m.maps[1].normal_scale = nan_f; });
    full("texels short", [&](Asset&, Mesh& m) { m.textures[4].texels.pop_back(); });
    full("no texels", [&](Asset&, Mesh& m) { m.textures[0] = {}; });
    full("texture without columns", [&](Asset&, Mesh& m) { m.textures[0] = {0, 5, {}}; });
    full("texture without rows", [&](Asset&, Mesh& m) { m.textures[0] = {5, 0, {}}; });
    full("texture of negative size", [&](Asset&, Mesh& m) {
        m.textures[1] = {-1, -2, m.textures[1].texels};
    });
    full("face_materials short", [&](Asset&, Mesh& m) { m.face_materials.pop_back(); });
    full("no such material", [&](Asset&, Mesh& m) { m.face_materials[1] = 2; });
    full("viewpoint NaN", [&](Asset&, Mesh& m) { m.viewpoint->x = nan; });
    full("piece that starts late", [&](Asset&, Mesh& m) { m.pieces[0].first_vertex = 1; });
    full("pieces that overlap", [&](Asset&, Mesh& m) { m.pieces[1].first_vertex = 2; });
    full("pieces that end early", [&](Asset&, Mesh& m) { m.pieces[1].vertices = 1; });
    full("pieces beyond V", [&](Asset&, Mesh& m) { m.pieces[1].vertices = ~0U; });
    full("absent in a mesh", [&](Asset&, Mesh& m) { m.absent = {2}; });
    cloud("absent beyond V", [](Mesh& m) { m.absent[1] = 3; });
    cloud("absent twice", [](Mesh& m) { m.absent[1] = 0; });
    cloud("absent that descends", [](Mesh& m) { m.absent = {2, 0}; });

    full("a material too many", [&](Asset& a, Mesh&) { a.materials.emplace_back(); });
    using M = MetallicRoughness;
    for (double M::*share :
         {&M::metallic, &M::roughness, &M::specular, &M::clearcoat, &M::clearcoat_roughness,
          &M::sheen_roughness, &M::anisotropy_strength}) {
        for (const double value : {-0.01, 1.01, nan}) {
            full("share", [&](Asset& a, Mesh&) { a.materials[0].*share = value; });
        }
    }
    for (Rgb M::*color : {&M::base_color, &M::sheen_color, &M::emissive}) {
        full("colour below 0", [&](Asset& a, Mesh&) { (a.materials[1].*color).g = -0.01; });
        full("colour above 1", [&](Asset& a, Mesh&) { (a.materials[1].*color).b = 1.01; });
    }
    full("specular colour", [&](Asset& a, Mesh&) { a.materials[0].specular_color.r = 2e12; });
    full("ior between 0 and 1", [&](Asset& a, Mesh&) { a.materials[0].ior = 0.5; });
    full("ior", [&](Asset& a, Mesh&) { a.materials[0].ior = infinite; });
    full("rotation", [&](Asset& a, Mesh&) { a.materials[0].anisotropy_rotation = 7.0; });
    full("emissive strength", [&](Asset& a, Mesh&) { a.materials[0].emissive_strength = 1e13; });

    const auto point = [](Asset& a) -> PointLight& { return std::get<0>(a.lights[0].shape); };
    const auto spot = [](Asset& a) -> SpotLight& { return std::get<1>(a.lights[2].shape); };
    const auto sun = [](Asset& a) -> DirectionalLight& { return std::get<2>(a.lights[3].shape); };
    full("power below 0", [&](Asset& a, Mesh&) { a.lights[0].power.g = -1.0; });
    full("power beyond a request's", [&](Asset& a, Mesh&) { a.lights[1].power.b = 2e12; });
    full("power infinite", [&](Asset& a, Mesh&) { a.lights[3].power.r = infinite; });
    full("light nowhere", [&](Asset& a, Mesh&) { point(a).position.x = nan; });
    full("range 0", [&](Asset& a, Mesh&) { point(a).range = 0.0; });
    full("range infinite", [&](Asset& a, Mesh&) { point(a).range = infinite; });
    full("spot nowhere", [&](Asset& a, Mesh&) { spot(a).position.z = 1e16; });
    full("spot without axis", [&](Asset& a, Mesh&) { spot(a).axis = Dir3{}; });
    full("inner cone below 0", [&](Asset& a, Mesh&) { spot(a).inner_cone = -0.1; });
    full("cones alike", [&](Asset& a, Mesh&) { spot(a).inner_cone = spot(a).outer_cone; });
    full("outer cone", [&](Asset& a, Mesh&) { spot(a).outer_cone = right_angle + 0.01; });
    full("sun without direction", [&](Asset& a, Mesh&) { sun(a).travel = Dir3{}; });
    full("sun of half the sky", [&](Asset& a, Mesh&) { sun(a).half_angle = right_angle + 0.01; });
    full("sun NaN wide", [&](Asset& a, Mesh&) { sun(a).half_angle = nan; });
    return broken;
}

}  // namespace relight::test
