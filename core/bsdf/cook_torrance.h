#pragma once

#include <memory>
#include <variant>
#include <vector>

#include "core/base/quantity.h"
#include "core/base/vec.h"
#include "core/bsdf/gtr.h"
#include "core/bsdf/multiscatter.h"
#include "core/bsdf/roughness.h"
#include "core/bsdf/terms.h"

namespace relight {

struct SchlickF0 {
    Rgb F0 = Rgb::grey(0.04);  ///< reflectance at normal incidence, [0, 1] a band
};
struct DielectricIor {
    double ior = 1.5;  ///< eta_t / eta_i
};
struct ConductorEtaK {
    Rgb eta, k;  ///< complex index eta + ik, a band
};
using FresnelModel = std::variant<SchlickF0, DielectricIor, ConductorEtaK>;

enum class Distribution { Beckmann, Ggx, Gtr };
enum class Shadowing { HeightCorrelated, Separable };

/// A rough boundary of mirror facets over a Lambertian base. Made by make_cook_torrance.
struct CookTorrance {
    Rgb albedo;  ///< of the base, linear; black leaves the facets alone (metals)
    bool albedo_from_vertex = false;  ///< take the vertex colour instead
    FresnelModel fresnel = SchlickF0{};
    Distribution distribution = Distribution::Ggx;
    double alpha_x = 0.25, alpha_y = 0.25;  ///< lobe widths along x and y of the frame
    double gamma = 2.0;                     ///< Gtr only: its exponent, > 0
    Shadowing shadowing = Shadowing::HeightCorrelated;
    bool multiscatter = false;  ///< Kulla-Conty compensation: light that facets hand on is kept
    std::shared_ptr<const gtr::Masking> gtr_masking;  ///< Gtr only: set by make_cook_torrance
    std::shared_ptr<const MultiscatterTable> lost;    ///< multiscatter only: likewise
    Rgb F_avg;                                        ///< multiscatter only: likewise
};

/// Completes a material: widths of at least least_alpha, and what Gtr and multiscatter need
/// beforehand (some milliseconds each). Gtr is isotropic: it takes alpha_x for both widths (at most
/// 1); with gamma = 2 it becomes Ggx, its equal.
CookTorrance make_cook_torrance(CookTorrance material);

/// F(u) a band, u = wi.h.
Rgb F(const FresnelModel& model, double u);

/// F_avg = 2 int F u du over [0, 1]: of light that meets facets from everywhere alike.
Rgb F_avg(const FresnelModel& model);

/// f = (1 - F(wi.h)) albedo / pi + F D G2 / (4 cos_i cos_o) + f_ms [1/sr]   Cook & Torrance 1982;
/// Walter 2007 in the frame whose z is the normal; 0 unless both directions are above the surface.
/// f_ms (multiscatter.h) only where it is asked for. Finite, reciprocal, not negative. The facets
/// alone never reflect more than they receive; with a bright base the sum can, at grazing, as in
/// glTF's like model.   Test: CookTorrance.*
BsdfValue f(const CookTorrance& material, Vec3 wi, Vec3 wo, Rgb vertex_color);

/// "D", "G2", "F", then the summands of f: "base" = (1 - F) albedo / pi, "specular" = F D G2 / (4
/// cos_i cos_o), "multiscatter" = f_ms; and "f".
std::vector<BsdfTerm> terms(const CookTorrance& material, Vec3 wi, Vec3 wo, Rgb vertex_color);

}  // namespace relight
