#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
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

/// The 8-bit codes that these colours came from; nothing if they did not.
inline std::vector<Rgb8> codes_of(std::span<const Rgbf> colors)
{
    const std::vector<float> table = decoded_srgb(255);
    std::vector<Rgb8> codes;
    codes.reserve(colors.size());
    for (const Rgbf& color : colors) {
        Rgb8 code{};
        for (std::size_t band = 0; band < 3; ++band) {
            const auto it = std::lower_bound(table.begin(), table.end(), color[band]);
            if (it == table.end() || *it != color[band]) { return {}; }
            code[band] = static_cast<unsigned char>(it - table.begin());
        }
        codes.push_back(code);
    }
    return codes;
}

}  // namespace relight
