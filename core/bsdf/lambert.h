#pragma once

#include <numbers>
#include <vector>

#include "core/base/quantity.h"
#include "core/base/vec.h"
#include "core/bsdf/terms.h"

namespace relight {

/// Reflects alike in every direction.
struct Lambert {
    Rgb albedo = Rgb::grey(0.8);      ///< M / E, linear, [0, 1] a band
    bool albedo_from_vertex = false;  ///< take the vertex colour instead
};

/// f = rho / pi [1/sr]: M = pi L = rho E fixes the constant.   Test: Lambert.*
/// 0 unless both directions (z = normal) are above the surface.
inline BsdfValue f(const Lambert& material, Vec3 wi, Vec3 wo, Rgb vertex_color)
{
    if (!(wi.z > 0.0 && wo.z > 0.0)) { return {}; }
    const Rgb rho = material.albedo_from_vertex ? vertex_color : material.albedo;
    return {rho / std::numbers::pi};
}

/// f is its one and only factor.
inline std::vector<BsdfTerm> terms(const Lambert& material, Vec3 wi, Vec3 wo, Rgb vertex_color)
{
    const Rgb value = f(material, wi, wo, vertex_color).value;
    return {{"diffuse", value}, {"f", value}};
}

}  // namespace relight
