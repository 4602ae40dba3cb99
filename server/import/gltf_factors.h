#pragma once

#include <array>
#include <cstddef>
#include <cstdio>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/rgb.h"
#include "server/import/gltf_file.h"

namespace relight::gltf {

/// Where the specifications set no bound: as much as a light of a request may have. Products of
/// three of them still are numbers in single precision.
inline constexpr double largest_factor = 1e12;

/// `length` numbers, each in [low, high]; nothing if the member is not there.
inline std::optional<std::vector<double>> factors(const Node& node, std::string_view key,
                                                  std::size_t length, double low, double high)
{
    auto values = node.numbers(key, length);
    for (std::size_t i = 0; values && i < length; ++i) {
        const double value = (*values)[i];
        if (value < low || value > high) {
            std::array<char, 96> range{};
            std::snprintf(range.data(), range.size(), "is %g, and must lie in [%g, %g]", value, low,
                          high);
            refuse(Fault::OutOfRange, node.at(key).where() + '/' + std::to_string(i), range.data());
        }
    }
    return values;
}

/// A colour, each band in [0, high].
inline Rgb color(const Node& node, std::string_view key, Rgb otherwise, double high = 1.0)
{
    const auto bands = factors(node, key, 3, 0.0, high);
    return bands ? Rgb{(*bands)[0], (*bands)[1], (*bands)[2]} : otherwise;
}

}  // namespace relight::gltf
