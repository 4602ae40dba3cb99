#pragma once

#include <variant>
#include <vector>

#include "core/base/quantity.h"
#include "core/base/sobol.h"
#include "core/base/vec.h"
#include "core/bsdf/cook_torrance.h"
#include "core/bsdf/lambert.h"
#include "core/bsdf/metallic_roughness.h"
#include "core/bsdf/oren_nayar.h"
#include "core/bsdf/principled.h"
#include "core/bsdf/terms.h"

namespace relight {

/// A new model is a file here and a line in this variant.
using Material = std::variant<Lambert, OrenNayar, CookTorrance, Principled, MetallicRoughness>;

/// f(wi, wo) [1/sr] in the frame whose z is the shading normal and x the tangent; 0 unless both are
/// above it. `vertex_color` replaces the albedo of a material that says so ("vertex").
BsdfValue f(const Material& material, Vec3 wi, Vec3 wo, Rgb vertex_color);

/// A direction to look for light in; one below the surface (z <= 0) counts as dark.
struct BsdfSample {
    Vec3 wi;           ///< unit
    double pdf = 0.0;  ///< [1/sr], of the whole mixture of lobes
};
/// Draws wi about where f(wi, wo) cos_i is large: a cosine lobe, visible normals of the facets and
/// a clear coat's, chosen by `pick` in [0, 1) with chances of wo's. Every model keeps some of the
/// cosine lobe, so that nothing f has is left out.   Test: BsdfSampling.*
BsdfSample sample(const Material& material, Vec3 wo, Rgb vertex_color, Sample2 s, double pick);
/// Its density, below the surface too; positive wherever f is.
double pdf(const Material& material, Vec3 wi, Vec3 wo, Rgb vertex_color);

/// Share of E that leaves diffusely, for bounces between surfaces: M / E of the base. What facets
/// and coats over it take is not taken off; a metal has none.
Rgb diffuse_albedo(const Material& material, Rgb vertex_color);

/// Radiance that the material sends out by itself on its front [W/(m^2 sr)] or [cd/m^2], toward
/// cos_o: a clear coat darkens it at grazing.
Rgb emission(const Material& material, double cos_o = 1.0);

/// f is the same for every pair of directions, so Lo = rho E / pi.
bool is_lambertian(const Material& material);

/// Its lobes differ along the tangent and across it: it needs a tangent frame.
bool is_anisotropic(const Material& material);

/// The factors of f(wi, wo), and under the name "f" their combination, bit for bit what f() gives.
std::vector<BsdfTerm> terms(const Material& material, Vec3 wi, Vec3 wo, Rgb vertex_color);

}  // namespace relight
