#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include "core/light/directional_light.h"
#include "core/light/environment.h"

namespace relight {

/// A clear sky with its sun: Preetham, Shirley & Smits 1999 ("A practical analytic model for
/// daylight"), luminances in cd/m^2 and E_perp in lx, linear Rec.709. +Y is up, +X east, -Z north.
/// The dome is tabulated; below the horizon there is nothing.   Test: Sky.*
struct SkyLight {
    std::shared_ptr<const EnvironmentMap> dome;
    DirectionalLight sun;  ///< a disc of half angle 0.2665 degrees
    Rgb sun_E_perp;        ///< [lx]; black once its disc has set
    double turbidity = 0.0;
};

/// Below 2 the model's fit has next to no light at the zenith and divides by it: at 1.7 its horizon
/// is five times as bright as at 2, where clearer air should dim it.
inline constexpr double least_turbidity = 2.0, largest_turbidity = 10.0;

/// @param toward_sun a sun below the horizon gives the sky of a sun on it, dimmed to nothing at
///        18 degrees below (the end of astronomical twilight); the disc fades as it sets
SkyLight make_sky(Dir3 toward_sun, double turbidity);

/// As any place sees it. `pick` chooses between sun and dome, half and half (one alone if the other
/// is dark).
class SkyView {
  public:
    explicit SkyView(const SkyLight& light);  ///< its dome outlives this

    LightSample sample(Sample2 s, double pick) const;
    LightSample look(Dir3 wi) const;

  private:
    /// Both parts along one direction.
    LightSample mixed(const LightSample& disc, const EnvironmentMap::Seen& dome) const;

    SunView sun_;
    Rgb E_perp_;
    const EnvironmentMap* dome_ = nullptr;  ///< null: it is dark
    double sun_share_;                      ///< of samples; 0: it is dark
};
LightSample sample(const SkyLight& light, Sample2 s, double pick);
LightSample look(const SkyLight& light, Dir3 wi);

/// Where the sun stands: +X east, +Y up, -Z north.   Within 0.02 degrees for 1950-2100 (refraction
/// not counted).   @param latitude, longitude [rad], north and east positive
/// @param unix_seconds UTC
Dir3 toward_sun(double latitude, double longitude, double unix_seconds);

/// Seconds since 1970 of an RFC 3339 time ("2026-06-21T12:00:00+02:00"); nothing if it is not one.
std::optional<double> rfc3339(std::string_view text);

}  // namespace relight
