#pragma once

#include <memory>

#include "core/base/random.h"
#include "tests/shade/pictures.h"

namespace relight::test {

/// A sky of columns x rows texels, each of its own random colour.
inline std::shared_ptr<const EnvironmentMap> patchwork(int columns, int rows)
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

inline CookTorrance mirror()
{
    CookTorrance facets;
    facets.fresnel = SchlickF0{Rgb::grey(1.0)};
    facets.alpha_x = facets.alpha_y = least_alpha;
    return make_cook_torrance(facets);
}

/// A glowing Lambertian material.
inline MetallicRoughness glowing(Rgb albedo, Rgb Le)
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
        : stage(staged(joined(joined(patch({0, 0, 0}, normalize({0, 0, 1}), 2.0),
                                     patch({0, 1.5, 1}, normalize({0, -1, 0}), 1.5)),
                              moved(icosphere(2), upright(), 0.4, {0.2, 0.1, 0.5}))))
    {
        scene.camera = {{0, -4, 2.5}, {0, 0, 0.4}, {0, 0, 1}, 0.6};
        MetallicRoughness material;
        material.base_color = {0.8, 0.6, 0.4};
        material.metallic = 0.3;
        material.roughness = 0.35;
        scene.materials[0] = material;
        scene.lights = {
            light_of(rect_of({-1, -1.5, 2.2}, {-1, -0.7, 2.2}, {-0.2, -1.5, 2.2}), {9, 8, 7}),
            light_of(EnvironmentLight{patchwork(16, 8), 0.4}, Rgb::grey(0.3)),
            light_of(PointLight{{1.2, -1, 1.5}, {}}, {1, 2, 3}),
            light_of(SphereLight{{-1.2, 0.9, 0.5}, 0.2}, {3, 2, 1})};
    }
    Stage stage;
    Scene scene;
};

inline double band(const Rgbf& c, std::size_t b)
{
    return static_cast<double>(c[b]);
}

}  // namespace relight::test
