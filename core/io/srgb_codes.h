#pragma once

#include <cstddef>
#include <vector>

#include "core/display/display.h"

namespace relight {

/// Linear value of each code 0..largest of an sRGB-encoded channel; ascending.
inline std::vector<float> decoded_srgb(std::size_t largest)
{
    std::vector<float> table(largest + 1);
    for (std::size_t code = 0; code <= largest; ++code) {
        table[code] =
            static_cast<float>(srgb_eotf(static_cast<double>(code) / static_cast<double>(largest)));
    }
    return table;
}

}  // namespace relight
