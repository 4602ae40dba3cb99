// A file's textures and normal maps pixel by pixel.
#include <gtest/gtest.h>

#include <numbers>

#include "core/geometry/tangents.h"
#include "tests/shade/pictures.h"
#include "tests/textures.h"

namespace relight {
namespace {

using test::Code;
using test::decoded;
using test::expect_near;
using test::lay;
using test::light_of;
using test::patches;
using test::picture;
using test::pictured_grid;
using test::plain;
using test::staged;

constexpr double pi = std::numbers::pi;
constexpr int side = 48;  // pixels
const Rgb sun_power{3.0, 2.0, 1.0};
const Dir3 toward_sun = normalize({-0.3, 0.2, 1.0});

/// The square under a sun, from above: the picture fills the image.
Scene scene_of(const Material& material, bool textured = true)
{
    Scene scene;
    scene.lights = {light_of(DirectionalLight{-toward_sun}, sun_power)};
    scene.materials = {material};
    if (textured) { scene.textured = {true}; }
    scene.camera = {{0, 0, 10}, {0, 0, 0}, {0, 1, 0}, 2.0 * std::atan(0.1)};
    return scene;
}

MetallicRoughness matt()
{
    MetallicRoughness material;
    material.metallic = 0.0;
    material.specular = 0.0;
    return material;
}

Rendered rendered(const Mesh& mesh, const Scene& scene, int samples = 4)
{
    RaytraceOptions options;
    options.width = options.height = side;
    options.samples = samples;
    options.normal = true;
    return picture(staged(mesh), scene, options);
}

/// The texel that a pixel lies in, of `columns` x `columns` that fill the image.
std::size_t texel_of(int x, int y, int columns)
{
    const int pixels = side / columns;
    const int texel = y / pixels * columns + x / pixels;
    return static_cast<std::size_t>(texel);
}

/// Texture coordinate of a pixel's place, from the left or the top.
double across(double pixel)
{
    return pixel / side;
}

TEST(TexturedPicture, APixelInsideATexelShowsThatTexel)
{
    Mesh mesh = pictured_grid(3);
    const Texture texture = patches(6, 6, 1);  // 8 pixels each
    mesh.maps[0].base_color = lay(mesh, texture, true);
    const Rendered seen = rendered(mesh, scene_of(matt()));
    const Rgb E = sun_power * toward_sun.z();
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            const Rgb rho = decoded(texture.texels[texel_of(x, y, 6)]);
            expect_near(to_double(seen.image.pixels[seen.image.at(x, y)]), rho * E / pi, 1e-6);
        }
    }
}

TEST(TexturedPicture, BetweenTexelsAPixelShowsTheirMixture)
{
    Mesh mesh = pictured_grid(1);  // two triangles: nothing of it comes from the vertices
    const Texture texture = patches(6, 6, 2);
    const TextureMap map = lay(mesh, texture);
    mesh.maps[0].base_color = map;
    const Rendered seen = rendered(mesh, scene_of(matt()), 16);
    const Rgb E = sun_power * toward_sun.z();
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            const auto rho = [&](double px, double py) {
                return sample_srgb(texture, map,
                                   {static_cast<float>(across(px)), static_cast<float>(across(py))})
                    .rgb;
            };
            // Pixels do not straddle the centres of texels: their corners bound what they show,
            // and the mean of the corners is near.
            const std::array<Rgb, 4> corners{rho(x, y), rho(x + 1, y), rho(x, y + 1),
                                             rho(x + 1, y + 1)};
            const auto band = [&](double Rgb::*b) {
                std::array<double, 4> values{};
                for (std::size_t k = 0; k < 4; ++k) { values[k] = corners[k].*b; }
                const auto [least, most] = std::minmax_element(values.begin(), values.end());
                return std::pair(0.25 * (values[0] + values[1] + values[2] + values[3]),
                                 *most - *least);
            };
            const auto [r, dr] = band(&Rgb::r);
            const auto [g, dg] = band(&Rgb::g);
            const auto [b, db] = band(&Rgb::b);
            expect_near(to_double(seen.image.pixels[seen.image.at(x, y)]), Rgb{r, g, b} * E / pi,
                        Rgb{dr, dg, db} * E / pi * 0.25 + Rgb::grey(1e-6));
        }
    }
}

TEST(TexturedPicture, UnderAnEvenSkyAMattTexelShowsItsShareOfIt)
{
    Mesh mesh = pictured_grid(1);
    const Texture texture = patches(2, 2, 3);
    mesh.maps[0].base_color = lay(mesh, texture, true);
    Scene scene = scene_of(matt());
    scene.lights = {light_of(EnvironmentLight{})};
    const Rendered seen = rendered(mesh, scene, 64);
    for (int texel = 0; texel < 4; ++texel) {
        Rgb sum;
        for (int i = 0; i < side * side / 4; ++i) {
            const int x = texel % 2 * side / 2 + i % (side / 2);
            const int y = texel / 2 * side / 2 + i / (side / 2);
            sum += to_double(seen.image.pixels[seen.image.at(x, y)]);
        }
        const Rgb rho = decoded(texture.texels[static_cast<std::size_t>(texel)]);
        expect_near(sum * (4.0 / side / side), rho, rho * 0.01);
    }
}

TEST(TexturedPicture, AShiningTextureIsSeenAsItself)
{
    Mesh mesh = pictured_grid(1);
    const Texture texture = patches(6, 6, 4);
    mesh.maps[0].emissive = lay(mesh, texture, true);
    MetallicRoughness material = matt();
    material.emissive = {1.0, 0.5, 0.25};
    material.emissive_strength = 3.0;
    Scene scene = scene_of(material);
    scene.lights.clear();
    const Rendered seen = rendered(mesh, scene);
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            const Rgb L = decoded(texture.texels[texel_of(x, y, 6)]);
            expect_near(to_double(seen.image.pixels[seen.image.at(x, y)]),
                        L * material.emissive * 3.0, 1e-6);
        }
    }
}

/// Four texels that lean left, right, up and down by some 30 degrees.
Mesh bumpy()
{
    Mesh mesh = pictured_grid(1);
    mesh.maps[0].normal = lay(
        mesh,
        {2,
         2,
         {{64, 128, 238, 255}, {191, 128, 238, 255}, {128, 191, 238, 255}, {128, 64, 238, 255}}},
        true);
    return mesh;
}

TEST(TexturedPicture, ANormalMapTurnsEachPixelsNormalForAnyMaterial)
{
    const Mesh mesh = bumpy();
    for (const bool filed : {true, false}) {  // the request's own material keeps the bumps
        const Rendered seen = filed ? rendered(mesh, scene_of(matt()))
                                    : rendered(mesh, scene_of(Lambert{Rgb::grey(1.0)}, false));
        for (int y = 0; y < side; ++y) {
            for (int x = 0; x < side; ++x) {
                const Code code = mesh.textures[0].texels[texel_of(x, y, 2)];
                const Dir3 n = normalize(
                    {code[0] / 127.5 - 1.0, code[1] / 127.5 - 1.0, code[2] / 127.5 - 1.0});
                const std::size_t at = seen.image.at(x, y);
                expect_near(to_double(seen.normal[at]), {n.x(), n.y(), n.z()}, 1e-6);
                expect_near(to_double(seen.image.pixels[at]),
                            sun_power * (std::max(0.0, dot(n, toward_sun)) / pi), 1e-6);
            }
        }
    }
}

TEST(TexturedPicture, LightFromBehindTheFaceDoesNotReachANormalThatLeansToIt)
{
    Mesh mesh = bumpy();
    mesh.textures[0] = plain({255, 128, 140, 255});  // lies down to the right
    Scene scene = scene_of(Lambert{}, false);
    scene.lights = {light_of(DirectionalLight{normalize({-1.0, 0.0, 0.05})})};
    for (const Rgbf L : rendered(mesh, scene).image.pixels) { EXPECT_EQ(L, (Rgbf{})); }
    scene.lights = {light_of(DirectionalLight{normalize({-1.0, 0.0, -0.05})})};
    for (const Rgbf L : rendered(mesh, scene).image.pixels) { EXPECT_GT(L[0], 0.2F); }
}

TEST(TexturedPicture, APixelAtAVertexHasTheVertexsNormal)
{
    Mesh mesh = test::icosphere(2);  // coordinates by place: any map
    for (const Point3 p : mesh.positions) {
        mesh.uvs.push_back({static_cast<float>(p.x + 0.3 * p.z), static_cast<float>(p.y)});
    }
    mesh.materials = {"bumpy"};
    mesh.face_materials.assign(mesh.faces.count(), 0);
    mesh.maps.resize(1);
    mesh.maps[0].normal = lay(mesh, patches(16, 16, 5));
    mesh.maps[0].normal_scale = 0.5F;
    const Stage stage = staged(mesh);
    Scene scene = scene_of(matt());
    RaytraceOptions options;
    options.width = options.height = 1;
    options.samples = 4;
    options.normal = true;
    int compared = 0;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        const Point3 p = mesh.positions[v];
        const Vec3 smooth = stage.surface->smooth_normals[v];
        const Vec3 bent = stage.surface->normals[v];
        if (dot(smooth, bent) < 0.2 || length(direction_of(stage.surface->tangents[v])) < 0.5) {
            continue;  // leant back, where the viewer would be below it
        }
        const bool mixed = std::any_of(
            stage.surface->triangles.begin(), stage.surface->triangles.end(), [&](const auto& t) {
                const auto sign = [&](unsigned k) { return stage.surface->tangents[k][3]; };
                return (t[0] == v || t[1] == v || t[2] == v) &&
                       !(sign(t[0]) == sign(t[1]) && sign(t[1]) == sign(t[2]));
            });
        if (mixed) { continue; }
        scene.camera = test::pinhead(p + smooth * 3.0, p);
        const Rendered seen = picture(stage, scene, options);
        expect_near(to_double(seen.normal[0]), {bent.x, bent.y, bent.z}, 1e-4);
        ++compared;
    }
    EXPECT_GT(compared, 60);
}

}  // namespace
}  // namespace relight
