#pragma once

#include <vector>

#include "core/bsdf/material.h"

namespace relight::kernel {

/// A GGX, Beckmann or GTR lobe of facets.
struct Facets {
    float inv_ax2 = 1.0F, inv_ay2 = 1.0F;  ///< 1 / alpha^2 along the lobe's axes
    float ax2 = 1.0F, ay2 = 1.0F;
    float peak = 0.0F;  ///< D along the normal [1/sr]
};

/// Fresnel's equations of a boundary of relative index N (complex), a band: |N^2 - 1|, and
/// N^2, N^2 - 1, N^2 + 1 with their shared imaginary part.
struct Boundary {
    float distance = 0.0F, N2 = 0.0F, less = 0.0F, more = 0.0F, imaginary = 0.0F;
};

/// A Material as the kernels read it: constants in float, formed in double. The model says which
/// count; formulas are those of core/bsdf.
struct Reflector {
    enum class Model {
        Lambert,
        OrenNayar,
        Beckmann,
        Ggx,
        Gtr,
        Principled,
        MetallicRoughness
    } model = Model::Lambert;
    bool anisotropic = false;
    double turn_cos = 1.0,
           turn_sin = 0.0;  ///< of the lobe's axes from the frame's, counter-clockwise

    float A = 1.0F, B = 0.0F;  ///< Oren-Nayar

    Facets facets, coat;

    // Cook-Torrance
    bool separable = false;
    unsigned boundaries = 0;  ///< 0: Schlick's F, from F0; 1: one for all bands; 3
    float F0[3]{};            ///< MetallicRoughness: of the dielectric
    Boundary boundary[3];
    float gamma = 2.0F;
    const float* gtr_table = nullptr;  ///< Masking::log_ratios()
    float gtr_scale = 0.0F;            ///< nodes for one of asinh(cos / alpha)
    float inv_alpha = 0.0F;
    const float* lost_table = nullptr;  ///< 1 - E_at_nodes(); null: no multiscatter
    float lost_inv_scale = 0.0F, lost_inv_reach = 0.0F;
    float F_ms[3]{};  ///< with the constant factor of f_ms

    // Principled
    float metallic = 0.0F, roughness = 0.0F, subsurface = 0.0F, specular = 0.0F;
    float specular_tint = 0.0F, sheen = 0.0F, sheen_tint = 0.0F;
    float clearcoat = 0.0F;  ///< Principled: with the factors of its lobe; else its strength

    // MetallicRoughness, and metallic, specular, clearcoat
    float F0_strongest = 0.0F;
    float sheen_color[3]{}, strongest_sheen = 0.0F;
    float charlie_exponent = 0.0F, charlie_norm = 0.0F;  ///< 1 / (2 alpha), (2 + 1/alpha) / (2 pi)
    float charlie_fit[5]{}, charlie_middle = 0.0F;       ///< Lambda_fit, 2 l(1/2)
    const float* sheen_table = nullptr;                  ///< E_over_cosines()
};

/// A Reflector with the tables that it points to.
struct PreparedMaterial {
    explicit PreparedMaterial(const Material& material);
    PreparedMaterial(const PreparedMaterial&) = delete;
    PreparedMaterial& operator=(const PreparedMaterial&) = delete;

    Reflector reflector;

  private:
    std::vector<float> gtr_, lost_, sheen_;
};

}  // namespace relight::kernel
