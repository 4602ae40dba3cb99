#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/light/directional_light.h"
#include "core/light/environment.h"
#include "core/light/light_sample.h"
#include "core/light/sky.h"

namespace relight {

/// A sky that is a map, with a sun's disc before it or without, the same from any place. What it
/// was made of outlives it.
struct Dome {
    const EnvironmentMap* map = nullptr;  ///< null: dark
    double cosine = 1.0, sine = 0.0;      ///< of its rotation about +Y
    std::optional<SunView> sun;
    double sun_share = 0.0;  ///< of samples
    Dir3 toward_sun;
    Rgb L_sun;             ///< of its disc
    double sun_pdf = 0.0;  ///< of sample(), there

    bool has_parts() const
    {
        return map != nullptr && sun.has_value();
    }  ///< sample() looks at pick
};
/// @param light has a map
Dome dome_of(const EnvironmentLight& light);
Dome dome_of(const SkyLight& light);

/// Directions by the hundred, in lanes.
struct DomeLanes {
    static constexpr std::size_t most = SeenLanes::most;

    // Plain arrays: g++ 12 makes no vectors of what it reads from a const std::array.
    alignas(64) double u[most], v[most], pick[most];  ///< samples
    alignas(64) double x[most], y[most], z[most];     ///< directions
    SeenLanes seen;                                   ///< along them
};
/// Of the first `count` lanes: sample(view, s, pick), or look(view, wi) along directions that are
/// there; in vectors where there is much to compute, and step by step where memory is slow.
/// A dark dome, which has neither map nor sun, is not drawn. Test: Draws.ASkysDirections*
void sample(const Dome& dome, std::size_t count, DomeLanes& lanes);
void look(const Dome& dome, std::size_t count, DomeLanes& lanes);

}  // namespace relight
