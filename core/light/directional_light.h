#pragma once

#include <algorithm>

#include "core/base/quantity.h"
#include "core/base/sobol.h"
#include "core/base/vec.h"
#include "core/light/light_sample.h"

namespace relight {

/// Light from infinitely far away, the same everywhere. Its power is E_perp, what it gives a
/// surface that faces it: a flux over 4 pi has no meaning here, and nothing falls off with
/// distance. With a half angle it is a uniform disc in the sky, L = E_perp / (pi sin^2).
struct DirectionalLight {
    Dir3 travel;              ///< the way its light travels
    double half_angle = 0.0;  ///< of its disc [rad], at most pi / 2; 0: a direction
};

/// E = E_perp (n . -travel)+ [W/m^2], independent of place. Unoccluded, of a direction.
/// Test: DirectionalLight.IsTheSameEverywhere
inline Irradiance irradiance(const DirectionalLight& light, Irradiance E_perp, Dir3 n)
{
    return E_perp * std::max(0.0, dot(n, -light.travel));
}

/// E of unit power facing n; also of a disc, cut by the horizon.   Test: Sun.*
double irradiance(const DirectionalLight& light, Dir3 n);
/// Of a disc (half angle > 0), uniform in solid angle.
LightSample sample(const DirectionalLight& light, Sample2 s);
LightSample look(const DirectionalLight& light, Dir3 wi);

}  // namespace relight
