#pragma once

#include <memory>
#include <variant>

#include "core/base/quantity.h"
#include "core/base/vec.h"
#include "core/bsdf/cook_torrance.h"
#include "core/bsdf/lambert.h"

namespace relight {

/// A new model is a file here and a line in this variant.
using Material = std::variant<Lambert, CookTorrance>;

/// f(wi, wo) [1/sr] in the frame whose z is the shading normal; 0 unless both are above it.
/// `vertex_color` replaces the albedo of a material that says so (albedo: "vertex").
BsdfValue f(const Material& material, Vec3 wi, Vec3 wo, Rgb vertex_color);

}  // namespace relight
