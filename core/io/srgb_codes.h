#pragma once

#include <algorithm>
#include <array>
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
    // Where to look for a value: codes lie 1/3295 apart or more, so a bin begins two at the most.
    constexpr std::size_t bins = 4096;
    const std::vector<float> table = decoded_srgb(255);
    std::array<unsigned char, bins + 1> first{};
    for (std::size_t bin = 0; bin <= bins; ++bin) {
        const float least = static_cast<float>(bin) / static_cast<float>(bins);
        const auto it = std::lower_bound(table.begin(), table.end(), least);
        first[bin] = static_cast<unsigned char>(it - table.begin());
    }
    std::vector<Rgb8> codes;
    codes.reserve(colors.size());
    for (const Rgbf& color : colors) {
        Rgb8 code{};
        for (std::size_t band = 0; band < 3; ++band) {
            const float x = color[band];
            if (!(x >= 0.0F && x <= 1.0F)) { return {}; }
            unsigned char found = first[static_cast<std::size_t>(x * static_cast<float>(bins))];
            while (table[found] < x) { ++found; }
            if (table[found] != x) { return {}; }
            code[band] = found;
        }
        codes.push_back(code);
    }
    return codes;
}

}  // namespace relight
