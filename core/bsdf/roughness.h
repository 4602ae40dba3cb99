#pragma once

#include <algorithm>

namespace relight {

/// Narrowest lobe we evaluate: below it the peak 1/(pi alpha^2) outgrows what a mesh's normals can
/// resolve. The floor Disney's model uses.
inline constexpr double least_alpha = 1e-3;

/// The request's roughness [0, 1] to the lobe's width: alpha = roughness^2, at least least_alpha.
/// The only such mapping.   Burley 2012, sec. 5.4
constexpr double alpha_from_roughness(double roughness)
{
    return std::max(least_alpha, roughness * roughness);
}

/// Widths of an anisotropic lobe along the x and the y of its own frame.
struct LobeWidths {
    double x = 1.0, y = 1.0;
};

}  // namespace relight
