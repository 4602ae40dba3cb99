#pragma once

#include "core/base/rgb.h"

namespace relight {

inline constexpr double least_temperature_k = 1000.0, largest_temperature_k = 40000.0;

/// Colour of a black body, linear Rec.709, luminance 1, no band below 0 (out of gamut below about
/// 1900 K: cut, then brought back to luminance 1). By integrating Planck's law against the CIE 1931
/// 2-degree observer (the multi-lobe fits of Wyman, Sloan & Shirley 2013).
/// Test: Temperature.*
Rgb blackbody(double kelvin);

}  // namespace relight
