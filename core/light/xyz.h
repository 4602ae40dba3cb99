#pragma once

#include <algorithm>

#include "core/base/rgb.h"

namespace relight {

/// CIE 1931 tristimulus values; Y is the luminance.
struct Xyz {
    double X{}, Y{}, Z{};
};

/// Linear Rec.709: the inverse of its primaries (.64 .33, .30 .60, .15 .06) and white D65
/// (.3127 .3290), ITU-R BT.709. Colours out of its gamut have a band below 0, which is cut.
constexpr Rgb rec709(Xyz c)
{
    const Rgb rgb{3.2409699419 * c.X - 1.5373831776 * c.Y - 0.4986107603 * c.Z,
                  -0.9692436363 * c.X + 1.8759675015 * c.Y + 0.0415550574 * c.Z,
                  0.0556300797 * c.X - 0.2039769589 * c.Y + 1.0569715142 * c.Z};
    return {std::max(0.0, rgb.r), std::max(0.0, rgb.g), std::max(0.0, rgb.b)};
}

}  // namespace relight
