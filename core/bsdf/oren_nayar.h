#pragma once

#include <vector>

#include "core/base/quantity.h"
#include "core/base/vec.h"
#include "core/bsdf/terms.h"

namespace relight {

/// A rough diffuse surface: Lambertian facets with Gaussian slopes.   Oren & Nayar 1994
struct OrenNayar {
    Rgb albedo = Rgb::grey(0.8);  ///< of the facets, linear, [0, 1] a band
    bool albedo_from_vertex = false;
    double sigma = 0.0;  ///< standard deviation of the slope angle [rad], 0..pi/2; 0 is Lambert
};

/// The qualitative model of the paper (eq. 30, light that meets two facets left out):
/// f = rho/pi (A + B max(0, cos dphi) sin(alpha) tan(beta)) [1/sr], alpha and beta the larger and
/// the smaller angle to the normal; 0 unless both directions (z = normal) are above the surface.
/// Finite, reciprocal, not negative. As published, a white one of sigma about 0.2 reflects up to
/// 1.5 % more than it receives at grazing.   Test: OrenNayar.*
BsdfValue f(const OrenNayar& material, Vec3 wi, Vec3 wo, Rgb vertex_color);

/// "A", "B", "lean" = max(0, cos dphi) sin(alpha) tan(beta), "diffuse" = "f" = rho/pi (A + B lean).
std::vector<BsdfTerm> terms(const OrenNayar& material, Vec3 wi, Vec3 wo, Rgb vertex_color);

}  // namespace relight
