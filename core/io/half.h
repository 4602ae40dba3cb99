#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace relight {

/// IEEE 754 binary16, rounded to the nearest, ties to even. What is too large for it (infinity too)
/// becomes the largest, +-65504; NaN stays NaN. The same bits on any instruction set. `out` is as
/// long as `values`.
void to_half(std::span<const float> values, std::uint16_t* out);

/// How many of the values rounding does not bring into its range: from half a step beyond 65504 on.
std::size_t beyond_half(std::span<const float> values);

}  // namespace relight
