#include "core/bsdf/material.h"

namespace relight {

BsdfValue f(const Material& material, Vec3 wi, Vec3 wo, Rgb vertex_color)
{
    return std::visit([&](const auto& model) { return f(model, wi, wo, vertex_color); }, material);
}

}  // namespace relight
