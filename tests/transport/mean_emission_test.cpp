// Triangles with a shining texture, as light: by the mean of what they show.
#include <gtest/gtest.h>

#include "core/transport/textured.h"
#include "tests/scenes.h"
#include "tests/textures.h"

namespace relight {
namespace {

using test::expect_near;
using test::lay;
using test::patches;
using test::pictured_grid;
using test::plain;
using test::staged;

/// Mean of a map over a triangle, by many random points.
Rgb drawn_mean(const Mesh& mesh, const TextureMap& map, const Triangle& t, int points)
{
    Rgb sum;
    for (int i = 0; i < points; ++i) {
        double b1 = uniform(9, static_cast<std::uint64_t>(i), 0, 0);
        double b2 = uniform(9, static_cast<std::uint64_t>(i), 0, 1);
        if (b1 + b2 > 1.0) { b1 = 1.0 - b1, b2 = 1.0 - b2; }
        const auto at = [&](std::size_t axis) {
            const auto uv = [&](std::size_t k) {
                return static_cast<double>(mesh.uvs[t[k]][axis]);
            };
            return static_cast<float>(uv(0) + b1 * (uv(1) - uv(0)) + b2 * (uv(2) - uv(0)));
        };
        sum += sample_srgb(mesh.textures[map.texture], map, {at(0), at(1)}).rgb;
    }
    return sum / points;
}

TEST(MeanEmission, IsTheFactorTimesTheMeanOfTheTexture)
{
    for (const int size : {1, 3, 40, 300}) {  // texels across: under, at and over the bound
        Mesh mesh = pictured_grid(1);
        mesh.uvs[3] = {0.1F, 0.9F};
        mesh.maps[0].emissive = lay(mesh, patches(size, size, 4));
        const Stage stage = staged(mesh);
        MetallicRoughness material;
        material.emissive = {1.0, 0.5, 0.25};
        material.emissive_strength = 7.0;
        for (std::uint32_t t = 0; t < 2; ++t) {
            const int points = 400'000;
            const Rgb drawn =
                drawn_mean(mesh, *mesh.maps[0].emissive, stage.surface->triangles[t], points);
            // Values lie in [0, 1]: the mean of the points errs by 0.5 / sqrt(points) at most.
            const double error = 4.0 * 0.5 / std::sqrt(points);
            const Rgb mean = mean_emission(material, mesh, *stage.surface, t) / 7.0;
            expect_near({mean.r, mean.g / 0.5, mean.b / 0.25}, drawn, error);
        }
    }
}

TEST(MeanEmission, OfARampIsThatOfItsCorners)
{
    Mesh mesh = pictured_grid(1);
    mesh.maps[0].emissive = lay(mesh, {2, 1, {{0, 0, 0, 255}, {255, 255, 255, 255}}});
    for (Uv& uv : mesh.uvs) { uv[0] = 0.25F + 0.5F * uv[0]; }  // from centre to centre: 0 to 1
    const Stage stage = staged(mesh);
    MetallicRoughness material;
    material.emissive = Rgb::grey(1.0);
    for (std::size_t t = 0; t < 2; ++t) {
        double corners = 0.0;
        for (const unsigned v : stage.surface->triangles[t]) {
            corners += 0.5 + 0.5 * mesh.positions[v].x;
        }
        expect_near(mean_emission(material, mesh, *stage.surface, t), Rgb::grey(corners / 3.0),
                    1e-7);
    }
}

TEST(MeanEmission, DoesNotBeatWithAPatternFinerThanItsPieces)
{
    Mesh mesh = pictured_grid(1);
    Texture quarter{4, 1, {{255, 255, 255, 255}, {}, {}, {}}};
    mesh.maps[0].emissive = lay(mesh, quarter, true);
    mesh.maps[0].emissive->wrap_u = Wrap::Repeat;
    MetallicRoughness material;
    material.emissive = Rgb::grey(1.0);
    for (const float repeats : {64.0F, 128.0F, 256.0F, 512.0F, 1000.0F}) {
        mesh.maps[0].emissive->transform[0] = repeats;
        const Stage stage = staged(mesh);
        expect_near(mean_emission(material, mesh, *stage.surface, 0), Rgb::grey(0.25), 0.01);
    }
}

TEST(MeanEmission, KeepsToTheCoatAndToMaterialsWithoutTextures)
{
    Mesh mesh = pictured_grid(1);
    mesh.maps[0].clearcoat = lay(mesh, plain({51, 0, 0, 255}));
    MetallicRoughness material;
    material.emissive = Rgb::grey(2.0);
    material.clearcoat = 0.5;
    const Stage stage = staged(mesh);
    // 1 - clearcoat F(0): F = 0.04.
    expect_near(mean_emission(material, mesh, *stage.surface, 0),
                Rgb::grey(2.0 * (1.0 - 0.5 * 0.2 * 0.04)), 1e-9);
    EXPECT_EQ(mean_emission(Lambert{}, mesh, *stage.surface, 0), Rgb{});
    mesh.maps.clear();
    EXPECT_EQ(mean_emission(material, mesh, *stage.surface, 0), emission(material, 1.0));
}

}  // namespace
}  // namespace relight
