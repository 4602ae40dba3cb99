#pragma once

#include <algorithm>
#include <limits>

#include "core/base/quantity.h"
#include "core/base/vec.h"
#include "core/base/warp.h"
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
/// A sun's disc (half angle > 0), drawn uniformly in solid angle. One narrower than 1e-60 rad has
/// no room for its radiance in double and shines as one of that width.
class SunView {
  public:
    explicit SunView(const DirectionalLight& light);

    LightSample sample(Sample2 s) const { return sample_direction(s); }
    LightSample look(Dir3 wi) const;

    double height() const { return height_; }  ///< 1 - cos of its half angle

    static constexpr bool is_seen() { return true; }
    LightSample sample_direction(Sample2 s) const
    {
        return seen(unit_already(frame_.to_world(warp::cap(s, height_))));
    }

  private:
    LightSample seen(Dir3 wi) const
    {
        return {wi, std::numeric_limits<double>::infinity(), Rgb::grey(L_), warp::cap_pdf(height_)};
    }

    Frame frame_;
    double height_, L_;  ///< 1 - cos of its half angle; its radiance
};
LightSample sample(const DirectionalLight& light, Sample2 s);
LightSample look(const DirectionalLight& light, Dir3 wi);

}  // namespace relight
