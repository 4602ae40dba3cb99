// A file's own materials, varied by its textures and vertex colours, at vertices.
#include "core/transport/textured.h"

#include <gtest/gtest.h>

#include <numbers>

#include "core/shade/shade.h"
#include "tests/scenes.h"
#include "tests/textures.h"

namespace relight {
namespace {

using test::Code;
using test::decoded;
using test::expect_near;
using test::lay;
using test::light_of;
using test::patches;
using test::pictured_grid;
using test::plain;
using test::staged;

constexpr double pi = std::numbers::pi;

/// Diffuse alone: f = base / pi.
MetallicRoughness matt(Rgb base = Rgb::grey(1.0))
{
    MetallicRoughness material;
    material.base_color = base;
    material.metallic = 0.0;
    material.specular = 0.0;
    return material;
}

/// A sun over a scene whose one material is the file's.
Scene scene_of(const Material& material, Vec3 travel = {0.3, -0.2, -1.0})
{
    Scene scene;
    scene.lights = {light_of(DirectionalLight{normalize(travel)}, {3.0, 2.0, 1.0})};
    scene.materials = {material};
    scene.textured = {true};
    return scene;
}

Shaded shaded(const Stage& stage, const Scene& scene)
{
    Progress progress;
    const Transport transport = trace(stage, scene, {}, progress);
    return shade(stage, transport, scene, {}, progress);
}

/// A clamped picture at (u, v), from its four texels around it.
Rgb bilinear(const Texture& texture, double u, double v)
{
    const double x = u * texture.width - 0.5, y = v * texture.height - 0.5;
    Rgb sum;
    for (int j = 0; j < 2; ++j) {
        for (int i = 0; i < 2; ++i) {
            const double column = std::floor(x) + i, row = std::floor(y) + j;
            const double weight = (1.0 - std::abs(x - column)) * (1.0 - std::abs(y - row));
            const auto at = static_cast<std::size_t>(std::clamp(row, 0.0, texture.height - 1.0) *
                                                         texture.width +
                                                     std::clamp(column, 0.0, texture.width - 1.0));
            sum += decoded(texture.texels[at]) * weight;
        }
    }
    return sum;
}

TEST(Textured, AMattVertexSendsOutTheTexturesValueThere)
{
    Mesh mesh = pictured_grid(9);
    const Texture texture = patches(5, 7, 1);
    mesh.maps[0].base_color = lay(mesh, texture);
    const Rgb factor{0.9, 0.5, 0.25};
    const Stage stage = staged(mesh);
    const Shaded lit = shaded(stage, scene_of(matt(factor)));
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        const Rgb rho = bilinear(texture, static_cast<double>(mesh.uvs[v][0]),
                                 static_cast<double>(mesh.uvs[v][1]));
        const Rgb E = to_double(lit.irradiance[v]);
        EXPECT_GT(E.r, 2.0);
        expect_near(to_double(lit.radiance[v]), factor * rho * E / pi, 1e-6);
    }
}

TEST(Textured, VertexColoursMultiplyFactorAndTexture)
{
    Mesh mesh = pictured_grid(2);
    const Code code{200, 120, 40, 255};
    mesh.maps[0].base_color = lay(mesh, plain(code));
    mesh.maps[0].base_color_factor = {0.9, 0.5, 0.25};
    for (std::size_t v = 0; v < 9; ++v) {
        mesh.colors.push_back({0.1F * static_cast<float>(v), 0.5F, 1.0F});
    }
    const Stage stage = staged(mesh);
    const MetallicRoughness material = matt(mesh.maps[0].base_color_factor);
    const Shaded lit = shaded(stage, scene_of(material));
    Scene vertex = scene_of(Lambert{{}, true});  // what a request calls "vertex"
    vertex.textured = {};
    const Shaded by_request = shaded(stage, vertex);
    for (std::size_t v = 0; v < 9; ++v) {
        const Rgb rho = material.base_color * decoded(code) * to_double(mesh.colors[v]);
        expect_near(vertex_color(stage, v), rho, 1e-7);
        expect_near(to_double(lit.radiance[v]), rho * to_double(lit.irradiance[v]) / pi, 1e-6);
        expect_near(to_double(by_request.radiance[v]), to_double(lit.radiance[v]), 1e-6);
    }
    const Hit hit{1.0, 0, 0.25, 0.5, false};  // vertices 0, 1, 4
    expect_near(
        color_at(stage, hit),
        (vertex_color(stage, 0) + vertex_color(stage, 1)) * 0.25 + vertex_color(stage, 4) * 0.5,
        1e-7);
}

TEST(Textured, AnotherMaterialThanTheFilesHasNoTexture)
{
    Mesh mesh = pictured_grid(2);
    mesh.maps[0].base_color = lay(mesh, patches(4, 4, 2));
    const Stage stage = staged(mesh);
    Scene scene = scene_of(matt());
    for (const std::vector<bool>& textured : {std::vector<bool>(), std::vector<bool>{false}}) {
        scene.textured = textured;
        EXPECT_EQ(&*vertex_material(stage, scene, {}, 4), &scene.materials[0]);
        EXPECT_EQ(&*material_at(stage, scene, {1.0, 3, 0.2, 0.3, false}), &scene.materials[0]);
    }
    const Shaded lit = shaded(stage, scene);
    for (const Rgbf L : lit.radiance) { EXPECT_EQ(L, lit.radiance[0]); }
}

TEST(Textured, WithoutTexturesAndColoursTheSceneSOwnMaterialIsTaken)
{
    Mesh mesh = pictured_grid(2);
    const Stage stage = staged(mesh);
    const Scene scene = scene_of(matt());
    EXPECT_EQ(&*vertex_material(stage, scene, {}, 4), &scene.materials[0]);
    EXPECT_EQ(&*material_at(stage, scene, {1.0, 3, 0.2, 0.3, false}), &scene.materials[0]);
}

TEST(Textured, EachTextureMultipliesItsFactor)
{
    Mesh mesh = pictured_grid(1);
    MaterialMaps maps;
    const auto code = [](int k) {
        return Code{static_cast<std::uint8_t>(40 + k), static_cast<std::uint8_t>(90 + 2 * k),
                    static_cast<std::uint8_t>(140 + 3 * k), static_cast<std::uint8_t>(250 - 5 * k)};
    };
    int k = 0;
    for (auto* map : {&maps.base_color, &maps.metallic_roughness, &maps.emissive, &maps.specular,
                      &maps.specular_color, &maps.clearcoat, &maps.clearcoat_roughness,
                      &maps.sheen_color, &maps.sheen_roughness, &maps.anisotropy}) {
        *map = lay(mesh, plain(code(k++)));
    }
    mesh.maps[0] = maps;
    const MetallicRoughness factors{.base_color = {0.9, 0.8, 0.7},
                                    .metallic = 0.9,
                                    .roughness = 0.8,
                                    .ior = 1.4,
                                    .specular = 0.7,
                                    .specular_color = {1.0, 0.9, 0.8},
                                    .clearcoat = 0.9,
                                    .clearcoat_roughness = 0.5,
                                    .sheen_color = {0.3, 0.6, 0.9},
                                    .sheen_roughness = 0.6,
                                    .anisotropy_strength = 0.7,
                                    .anisotropy_rotation = 0.4,
                                    .emissive = {0.2, 0.4, 0.6},
                                    .emissive_strength = 5.0};
    const auto share = [&](int map, std::size_t channel) { return code(map)[channel] / 255.0; };
    MetallicRoughness built = factors;
    built.base_color = factors.base_color * decoded(code(0));
    built.roughness *= share(1, 1);
    built.metallic *= share(1, 2);
    built.emissive = factors.emissive * decoded(code(2));
    built.specular *= share(3, 3);
    built.specular_color = factors.specular_color * decoded(code(4));
    built.clearcoat *= share(5, 0);
    built.clearcoat_roughness *= share(6, 1);
    built.sheen_color = factors.sheen_color * decoded(code(7));
    built.sheen_roughness *= share(8, 3);
    built.anisotropy_rotation += std::atan2(2.0 * share(9, 1) - 1.0, 2.0 * share(9, 0) - 1.0);
    built.anisotropy_strength *= share(9, 2);

    const Stage stage = staged(mesh);
    Scene textured = scene_of(factors), plainly = scene_of(built);
    plainly.textured = {};
    const LocalMaterial here = vertex_material(stage, textured, {}, 2);
    const LocalMaterial there = material_at(stage, textured, {1.0, 1, 0.3, 0.3, false});
    const Material expected = built;
    for (const Vec3 direction : {Vec3{0.3, -0.2, 1}, Vec3{-2, 0.4, 1}, Vec3{0.1, 3, 1}}) {
        const Vec3 wi = normalize(direction), wo = normalize({-0.4, 0.1, 0.6});
        const Rgb value = f(expected, wi, wo, {}).value;
        expect_near(f(*here, wi, wo, {}).value, value, 1e-9);
        expect_near(f(*there, wi, wo, {}).value, value, 1e-9);
        expect_near(emission(*here, 0.4), emission(expected, 0.4), 1e-9);
    }
    const Shaded a = shaded(stage, textured), b = shaded(stage, plainly);
    for (std::size_t v = 0; v < 4; ++v) {
        expect_near(to_double(a.radiance[v]), to_double(b.radiance[v]), 1e-6);
    }
}

/// A brushed, bumpy, painted square.
Mesh brushed()
{
    Mesh mesh = pictured_grid(3);
    mesh.maps[0].base_color = lay(mesh, patches(4, 4, 3));
    mesh.maps[0].normal = lay(mesh, plain({170, 100, 230, 255}));
    mesh.maps[0].anisotropy = lay(mesh, plain({255, 190, 220, 255}));
    return mesh;
}

TEST(Textured, AMirroredMeshUnderMirroredLightIsAsBright)
{
    Mesh mirrored = brushed();
    for (Point3& p : mirrored.positions) { p.x = -p.x; }
    for (std::size_t c = 0; c < mirrored.faces.indices.size(); c += 3) {
        std::swap(mirrored.faces.indices[c], mirrored.faces.indices[c + 1]);  // still facing +z
    }
    MetallicRoughness metal;
    metal.roughness = 0.3;
    metal.anisotropy_strength = 0.9;
    metal.anisotropy_rotation = 0.5;
    Scene scene = scene_of(metal, {0.5, 0.4, -1.0});
    scene.view = DirectionView{normalize({0.6, 0.1, 1.0})};
    const Stage plain_stage = staged(brushed());
    const Shaded straight = shaded(plain_stage, scene);
    scene.lights = {light_of(DirectionalLight{normalize({-0.5, 0.4, -1.0})}, {3.0, 2.0, 1.0})};
    scene.view = DirectionView{normalize({-0.6, 0.1, 1.0})};
    const Stage stage = staged(mirrored);
    EXPECT_EQ(stage.surface->tangents[0][3], -1.0F);
    const Shaded other = shaded(stage, scene);
    const auto rotation = [&](const Stage& of, const Hit& hit) {
        return std::get<MetallicRoughness>(*material_at(of, scene, hit)).anisotropy_rotation;
    };
    const double turned = rotation(plain_stage, {1.0, 0, 0.3, 0.2, false});
    EXPECT_GT(turned, 0.5);
    EXPECT_DOUBLE_EQ(rotation(stage, {1.0, 0, 0.3, 0.2, false}), -turned);
    for (std::size_t v = 0; v < 16; ++v) {
        const Rgb L = to_double(straight.radiance[v]);
        EXPECT_GT(L.r, 1e-4);
        expect_near(to_double(other.radiance[v]), L, 1e-5 * L.r);
    }
}

TEST(Textured, AVertexOnTheBorderOfTwoGroupsHasThatOfItsFirstFace)
{
    Mesh mesh = pictured_grid(2);
    mesh.materials = {"red", "green", "none"};
    mesh.maps.resize(3);
    mesh.maps[0].base_color = lay(mesh, plain({255, 0, 0, 255}));
    mesh.maps[1].base_color = lay(mesh, plain({0, 255, 0, 255}));
    mesh.face_materials = {0, 0, 2, 2, 1, 1, 2, 2};
    Scene scene = scene_of(matt());
    scene.material_of_group = {0, 0, 1};
    scene.materials.emplace_back(matt(Rgb::grey(0.5)));
    scene.textured = {true, true};
    const Stage stage = staged(mesh);
    const auto materials = vertex_materials(stage, scene);
    const auto base = [&](std::size_t v) {
        return std::get<MetallicRoughness>(*vertex_material(stage, scene, materials, v)).base_color;
    };
    for (const std::size_t v : {0U, 1U, 3U, 4U}) { EXPECT_EQ(base(v), (Rgb{1, 0, 0})) << v; }
    for (const std::size_t v : {6U, 7U}) { EXPECT_EQ(base(v), (Rgb{0, 1, 0})) << v; }
    for (const std::size_t v : {2U, 5U, 8U}) { EXPECT_EQ(base(v), Rgb::grey(0.5)) << v; }
    const auto of_face = [&](std::uint32_t face) {
        return std::get<MetallicRoughness>(*material_at(stage, scene, {1, face, 0.3, 0.3, false}))
            .base_color;
    };
    EXPECT_EQ(of_face(1), (Rgb{1, 0, 0}));
    EXPECT_EQ(of_face(5), (Rgb{0, 1, 0}));
    EXPECT_EQ(of_face(7), Rgb::grey(0.5));
}

TEST(Textured, BouncesBringTheTexturesColour)
{
    // A floor, black to the left and red to the right, under a ceiling; once as a picture, once as
    // two materials.
    const int n = 8;
    Mesh painted = test::joined(
        pictured_grid(n),
        test::moved(test::grid(n),
                    {normalize({1, 0, 0}), normalize({0, -1, 0}), normalize({0, 0, -1})}, 1.0,
                    {0, 0, 1.5}));
    painted.materials.emplace_back("ceiling");
    painted.face_materials.resize(painted.faces.count(), 1);
    painted.uvs.resize(painted.positions.size());
    Mesh grouped = painted;
    const std::size_t ceiling = painted.faces.count() / 2;
    painted.maps.resize(2);
    painted.maps[0].base_color = lay(painted, {2, 1, {{0, 0, 0, 255}, {255, 0, 0, 255}}}, true);
    grouped.maps.clear();
    grouped.materials.emplace_back("right");
    for (std::size_t f = 0; f < ceiling; ++f) {
        const Point3 p = grouped.positions[grouped.faces.indices[3 * f]];
        if (p.x >= 0.0) { grouped.face_materials[f] = 2; }
    }
    Scene scene = scene_of(matt(), {0.6, 0.0, -0.5});
    scene.transport.bounces = 2;
    scene.transport.samples = 64;
    scene.materials = {matt(), matt()};
    scene.material_of_group = {0, 1};
    scene.textured = {true, true};
    const Shaded by_picture = shaded(staged(painted), scene);
    scene.materials = {matt({0, 0, 0}), matt(), matt({1, 0, 0})};
    scene.material_of_group = {0, 1, 2};
    scene.textured = {};
    const Shaded by_groups = shaded(staged(grouped), scene);
    EXPECT_EQ(by_picture.irradiance, by_groups.irradiance);
    const std::size_t under = painted.positions.size() * 3 / 4;  // the middle of the ceiling
    EXPECT_GT(by_picture.irradiance[under][0], 0.01F);
    EXPECT_EQ(by_picture.irradiance[under][1], 0.0F);
}

TEST(Textured, ACloudHasItsColoursButNoTexture)
{
    Mesh cloud = pictured_grid(3);
    cloud.faces = {};
    cloud.face_materials.clear();
    cloud.normals.assign(16, {0, 0, 1});
    cloud.colors.assign(16, {0.5F, 0.25F, 1.0F});
    cloud.maps[0].base_color = lay(cloud, plain({}));
    const Stage stage = staged(cloud);
    const Scene scene = scene_of(matt({0.5, 0.5, 0.5}));
    const auto base = [](const LocalMaterial& material) {
        return std::get<MetallicRoughness>(*material).base_color;
    };
    EXPECT_EQ(base(vertex_material(stage, scene, {}, 5)), (Rgb{0.25, 0.125, 0.5}));
    EXPECT_EQ(base(material_at(stage, scene, {1, 5, 0, 0, true})), (Rgb{0.25, 0.125, 0.5}));
    EXPECT_EQ(vertex_color(stage, 5), (Rgb{0.5, 0.25, 1.0}));
}

TEST(Textured, AnyFiniteCoordinatesGiveFiniteLight)
{
    Mesh mesh = brushed();
    constexpr float most = std::numeric_limits<float>::max();
    for (std::size_t v = 0; v < mesh.uvs.size(); ++v) {
        mesh.uvs[v] = {v % 2 == 0 ? most : -most, v % 3 == 0 ? most : 1e-40F};
    }
    mesh.maps[0].emissive = mesh.maps[0].base_color;
    MetallicRoughness material = matt();
    material.emissive = Rgb::grey(1.0);
    const Stage stage = staged(mesh);
    for (const Rgbf L : shaded(stage, scene_of(material)).radiance) {
        for (const float band : L) { EXPECT_TRUE(std::isfinite(band) && band >= 0.0F); }
    }
    for (std::uint32_t t = 0; t < stage.surface->triangles.size(); ++t) {
        const Rgb L = mean_emission(material, mesh, *stage.surface, t);
        EXPECT_TRUE(is_finite(luminance(L)) && L.r >= 0.0 && L.r <= 1.0);
        const Rgb rho = color_at(stage, {1.0, t, 0.3, 0.7, false});
        EXPECT_TRUE(is_finite(luminance(rho)));
    }
}

}  // namespace
}  // namespace relight
