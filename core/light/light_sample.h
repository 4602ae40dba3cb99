#pragma once

#include <cstddef>
#include <limits>

#include "core/base/rgb.h"
#include "core/base/vec.h"

namespace relight {

/// What a light of unit power shows to a place along one direction.
struct LightSample {
    Dir3 wi;  ///< toward the light; "no direction": there is nothing to be seen
    double distance = std::numeric_limits<double>::infinity();  ///< to it, scene units
    Rgb L;             ///< radiance that arrives, unoccluded
    double pdf = 0.0;  ///< with which the light's sample() draws wi [1/sr]
};

/// The same along many directions, field by field. Plain arrays: g++ 12 makes no vectors of what it
/// reads from a const std::array.
struct SeenLanes {
    static constexpr std::size_t most = 1040;  ///< whole vectors

    alignas(64) double red[most], green[most], blue[most];  ///< L
    alignas(64) double pdf[most];                           ///< 0: nothing is seen

    Rgb L(std::size_t lane) const { return {red[lane], green[lane], blue[lane]}; }
};

}  // namespace relight
