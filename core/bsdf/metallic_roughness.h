#pragma once

#include <vector>

#include "core/base/quantity.h"
#include "core/base/vec.h"
#include "core/bsdf/roughness.h"
#include "core/bsdf/terms.h"

namespace relight {

/// glTF 2.0 metallic-roughness (Appendix B) with the extensions KHR_materials_clearcoat, _sheen,
/// _specular, _ior, _anisotropy and _emissive_strength, factors only.
struct MetallicRoughness {
    Rgb base_color = Rgb::grey(1.0);  ///< linear
    bool base_color_from_vertex = false;
    double metallic = 1.0, roughness = 1.0;
    double ior = 1.5;                     ///< 1.., or 0: reflects wholly (KHR_materials_ior)
    double specular = 1.0;                ///< weight of the dielectric's reflection
    Rgb specular_color = Rgb::grey(1.0);  ///< of it at normal incidence; may exceed 1
    double clearcoat = 0.0, clearcoat_roughness = 0.0;
    Rgb sheen_color;  ///< [0, 1] a band
    double sheen_roughness = 0.0;
    double anisotropy_strength = 0.0;  ///< [0, 1]
    double anisotropy_rotation = 0.0;  ///< counter-clockwise from the tangent [rad]
    Rgb emissive;                      ///< [0, 1] a band
    double emissive_strength = 1.0;    ///< radiance of emissive 1 [cd/m^2 or W/(m^2 sr)]
};

/// Of the base's lobe, in its own frame: x is the tangent turned by anisotropy_rotation.
/// alpha_x = mix(alpha, 1, strength^2), alpha_y = alpha.   KHR_materials_anisotropy
LobeWidths lobe_widths(const MetallicRoughness& material);

/// The layers from below, as the KHR texts stack them [1/sr]:
///   base  = mix((1 - max F_d) base/pi + F_d DV, F_m DV, metallic)
///   cloth = min(1 - c E(cos_i), 1 - c E(cos_o)) base + sheen_color D V (Charlie), c its largest
///   f     = mix(cloth, DV of the coat, clearcoat F_c(cos_o))
/// F_d runs from specular min(1, F0(ior) specular_color) to specular, F_m from the base colour to
/// 1, F_c from 0.04 to 1. In the frame whose z is the normal and x the tangent; 0 unless both
/// directions are above the surface. As published, not clamped to conserve energy, but for two
/// things that keep f a positive number: roughness is floored (roughness.h), E is at most 1.
///
/// Without a clear coat f is reciprocal. With one it is not: the text takes the coat's Fresnel at
/// n.wo instead of h.wo, so f(wi, wo) - cloth goes with F_c(cos_o) and turns to F_c(cos_i) when the
/// two directions change places.   Test: MetallicRoughness.*, ModelOracle.*
BsdfValue f(const MetallicRoughness& material, Vec3 wi, Vec3 wo, Rgb vertex_color);

/// emissive emissive_strength (1 - clearcoat F_c(cos_o)): the coat lies over it too, so it darkens
/// toward grazing.   KHR_materials_clearcoat, "Emission"
Rgb emission(const MetallicRoughness& material, double cos_o);

/// "D", "G2", "V" of the base's lobe and its "F" (dielectric and metal mixed), then the summands of
/// f, weights of all layers above included: "diffuse", "specular", "sheen", "clearcoat"; and "f".
std::vector<BsdfTerm> terms(const MetallicRoughness& material, Vec3 wi, Vec3 wo, Rgb vertex_color);

}  // namespace relight
