#pragma once

#include <vector>

#include "core/base/quantity.h"
#include "core/base/vec.h"
#include "core/bsdf/roughness.h"
#include "core/bsdf/terms.h"

namespace relight {

/// Disney's principled BRDF of 2012: a base colour and ten scalars in [0, 1].   Burley 2012
struct Principled {
    Rgb base_color = Rgb::grey(0.8);  ///< linear
    bool base_color_from_vertex = false;
    double metallic = 0.0, subsurface = 0.0, specular = 0.5, roughness = 0.5, specular_tint = 0.0,
           anisotropic = 0.0, sheen = 0.0, sheen_tint = 0.5, clearcoat = 0.0, clearcoat_gloss = 1.0;
};

/// Of the specular lobe: roughness^2 over and times sqrt(1 - 0.9 anisotropic), floored.
LobeWidths lobe_widths(const Principled& material);

/// f = (1 - metallic) (diffuse base/pi + sheen) + specular + clear coat [1/sr] in the frame whose z
/// is the normal and x the tangent; 0 unless both directions are above the surface. As published
/// (contract section 5): reciprocal and not negative, but not energy conserving (a white base
/// reflects up to 1.5 of what it receives, with sheen). The 2012 notes differ from the corrected
/// reference shader; we follow the latter: masking takes the unremapped widths, base_color is
/// linear already. The clear coat's masking (GGX, 0.25) is not that of its own distribution (GTR of
/// exponent 1), and its 0.25 is strength.   Test: Principled.*, ModelOracle.*
BsdfValue f(const Principled& material, Vec3 wi, Vec3 wo, Rgb vertex_color);

/// "D", "G2", "V", "F" of the specular lobe, then the summands of f, weights included: "diffuse",
/// "sheen", "specular", "clearcoat"; and "f".
std::vector<BsdfTerm> terms(const Principled& material, Vec3 wi, Vec3 wo, Rgb vertex_color);

}  // namespace relight
