#pragma once

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

}  // namespace relight
