// Pictures under every light, with bounces: against closed forms and the oracle's values.
#include <gtest/gtest.h>

#include "core/base/random.h"
#include "tests/oracle.h"
#include "tests/shade/pictures.h"
#include "tests/statistics.h"

namespace relight {
namespace {

using nlohmann::json;
using test::light_of;
using test::Mean;
using test::mean_of;
using test::NormalisedErrors;
using test::oracle;
using test::picture;
using test::point_of;
using test::rgb_of;
using test::staged;
using test::vec_of;

constexpr double pi = std::numbers::pi;

/// A sky of columns x rows texels, each of its own random colour.
std::shared_ptr<const EnvironmentMap> patchwork(int columns, int rows)
{
    Image image;
    image.width = columns;
    image.height = rows;
    for (std::uint64_t i = 0;
         i < static_cast<std::uint64_t>(columns) * static_cast<std::uint64_t>(rows); ++i) {
        image.pixels.push_back(to_float({0.1 + uniform(5, i, 0, 0), 0.1 + uniform(5, i, 0, 1),
                                         0.1 + 3.0 * uniform(5, i, 0, 2)}));
    }
    return std::make_shared<const EnvironmentMap>(std::move(image));
}

CookTorrance mirror()
{
    CookTorrance facets;
    facets.fresnel = SchlickF0{Rgb::grey(1.0)};
    facets.alpha_x = facets.alpha_y = least_alpha;
    return make_cook_torrance(facets);
}

/// A glowing Lambertian material.
MetallicRoughness glowing(Rgb albedo, Rgb Le)
{
    MetallicRoughness material;
    material.base_color = albedo;
    material.metallic = 0.0;
    material.specular = 0.0;
    material.emissive = Le;
    return material;
}

/// A ball over a floor beside a wall, under every kind of light that casts soft light.
struct Corner {
    Corner()
        : stage(staged(
              test::joined(test::joined(test::patch({0, 0, 0}, normalize({0, 0, 1}), 2.0),
                                        test::patch({0, 1.5, 1}, normalize({0, -1, 0}), 1.5)),
                           test::moved(test::icosphere(2), test::upright(), 0.4, {0.2, 0.1, 0.5}))))
    {
        scene.camera = {{0, -4, 2.5}, {0, 0, 0.4}, {0, 0, 1}, 0.6};
        MetallicRoughness material;
        material.base_color = {0.8, 0.6, 0.4};
        material.metallic = 0.3;
        material.roughness = 0.35;
        scene.materials[0] = material;
        scene.lights = {
            light_of(test::rect_of({-1, -1.5, 2.2}, {-1, -0.7, 2.2}, {-0.2, -1.5, 2.2}), {9, 8, 7}),
            light_of(EnvironmentLight{patchwork(16, 8), 0.4}, Rgb::grey(0.3)),
            light_of(PointLight{{1.2, -1, 1.5}, {}}, {1, 2, 3}),
            light_of(SphereLight{{-1.2, 0.9, 0.5}, 0.2}, {3, 2, 1})};
    }
    Stage stage;
    Scene scene;
};

TEST(RaytraceLight, TheErrorOfAPixelIsHonest)
{
    const Corner corner;
    constexpr int width = 16, height = 12, seeds = 100;
    const Rendered truth = picture(corner.stage, corner.scene, {width, height, 6400, {}, 999, 0});
    int within = 0, all = 0;
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        const Rendered one = picture(corner.stage, corner.scene, {width, height, 16, {}, seed, 0});
        for (std::size_t i = 0; i < one.image.pixels.size(); ++i) {
            for (std::size_t band = 0; band < 3; ++band) {
                const double off = static_cast<double>(one.image.pixels[i][band]) -
                                   static_cast<double>(truth.image.pixels[i][band]);
                const double slack = 2.0 * static_cast<double>(truth.standard_error[i][band]);
                const auto error = static_cast<double>(one.standard_error[i][band]);
                within += std::abs(off) <= 1.96 * error + 0.0 * slack ? 1 : 0;
                ++all;
            }
        }
    }
    const double share = static_cast<double>(within) / all;
    EXPECT_GE(share, 0.92);
    EXPECT_LE(share, 0.98);
    std::printf("share %g\n", share);
}

}  // namespace
}  // namespace relight
