#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "core/light/directional_light.h"
#include "core/light/environment.h"
#include "core/light/sky.h"

namespace relight {

/// A sky that is a map, with a sun's disc before it or without, the same from any place. What it
/// was made of outlives it.
struct Dome {
    const EnvironmentMap* map = nullptr;  ///< null: dark
    double cosine = 1.0, sine = 0.0;      ///< of its rotation about +Y
    std::optional<SunView> sun;
    Rgb E_perp;              ///< of the sun
    double sun_share = 0.0;  ///< of samples
};
/// @param light has a map
Dome dome_of(const EnvironmentLight& light);
Dome dome_of(const SkyLight& light);

/// Directions by the hundred, in lanes.
struct DomeLanes {
    static constexpr std::size_t most = 1040;  ///< whole vectors

    // Plain arrays: g++ 12 makes no vectors of what it reads from a const std::array.
    alignas(64) double u[most], v[most], pick[most];  ///< samples
    alignas(64) double x[most], y[most], z[most];     ///< directions
    Rgb L[most];                                      ///< what it shows along them
    double pdf[most];                                 ///< of sample() [1/sr]
};
/// Of the first `count` lanes: directions of samples, as sample(view, s, pick) draws them, and what
/// is seen along directions, as look(view, wi) has it; in vectors where there is much to compute,
/// and step by step where memory is slow. Test: Draws.ASkysDirections*
void sample(const Dome& dome, std::size_t count, DomeLanes& lanes);
void look(const Dome& dome, std::size_t count, DomeLanes& lanes);

}  // namespace relight
