#include "core/bsdf/material.h"

namespace relight {
namespace {

struct DiffuseAlbedo {
    Rgb vertex_color;

    Rgb operator()(const Lambert& m) const
    {
        return m.albedo_from_vertex ? vertex_color : m.albedo;
    }
    Rgb operator()(const OrenNayar& m) const
    {
        return m.albedo_from_vertex ? vertex_color : m.albedo;
    }
    Rgb operator()(const CookTorrance& m) const
    {
        return m.albedo_from_vertex ? vertex_color : m.albedo;
    }
    Rgb operator()(const Principled& m) const { return dielectric(m); }
    Rgb operator()(const MetallicRoughness& m) const { return dielectric(m); }

    template <class Model>
    Rgb dielectric(const Model& m) const
    {
        return (m.base_color_from_vertex ? vertex_color : m.base_color) * (1.0 - m.metallic);
    }
};

}  // namespace

BsdfValue f(const Material& material, Vec3 wi, Vec3 wo, Rgb vertex_color)
{
    return std::visit([&](const auto& model) { return f(model, wi, wo, vertex_color); }, material);
}

Rgb diffuse_albedo(const Material& material, Rgb vertex_color)
{
    return std::visit(DiffuseAlbedo{vertex_color}, material);
}

Rgb emission(const Material& material, double cos_o)
{
    const auto* model = std::get_if<MetallicRoughness>(&material);
    return model == nullptr ? Rgb{} : emission(*model, cos_o);
}

bool is_lambertian(const Material& material)
{
    if (const auto* model = std::get_if<OrenNayar>(&material)) { return model->sigma == 0.0; }
    return std::holds_alternative<Lambert>(material);
}

bool is_anisotropic(const Material& material)
{
    const auto differ = [](LobeWidths alpha) { return alpha.x != alpha.y; };
    if (const auto* facets = std::get_if<CookTorrance>(&material)) {
        return differ({facets->alpha_x, facets->alpha_y});
    }
    if (const auto* disney = std::get_if<Principled>(&material)) {
        return differ(lobe_widths(*disney));
    }
    if (const auto* gltf = std::get_if<MetallicRoughness>(&material)) {
        return differ(lobe_widths(*gltf));
    }
    return false;
}

std::vector<BsdfTerm> terms(const Material& material, Vec3 wi, Vec3 wo, Rgb vertex_color)
{
    return std::visit([&](const auto& model) { return terms(model, wi, wo, vertex_color); },
                      material);
}

}  // namespace relight
