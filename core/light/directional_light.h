#pragma once

#include <algorithm>

#include "core/base/quantity.h"
#include "core/base/vec.h"

namespace relight {

/// Light from infinitely far away, the same everywhere. Its power is E_perp, what it gives a
/// surface that faces it: a flux over 4 pi has no meaning here, and nothing falls off with
/// distance.
struct DirectionalLight {
    Dir3 travel;  ///< the way its light travels
};

/// E = E_perp (n . -travel)+ [W/m^2], independent of place. Unoccluded.
/// Test: DirectionalLight.IsTheSameEverywhere
inline Irradiance irradiance(const DirectionalLight& light, Irradiance E_perp, Dir3 n)
{
    return E_perp * std::max(0.0, dot(n, -light.travel));
}

}  // namespace relight
