#pragma once

#include <cstddef>
#include <span>

#include "core/base/rgb.h"

namespace relight {

/// Values beyond single precision become its largest: an answer holds finite numbers only. Returns
/// how many there were.
std::size_t clamp_to_finite(std::span<Rgbf> values, unsigned threads);

}  // namespace relight
