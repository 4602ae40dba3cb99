#pragma once

#include <cstdint>
#include <span>

#include "core/base/parallel.h"

namespace relight {

/// Sorts by the highest 30 bits; items equal in these keep their order. The same for any number of
/// threads; of no use once `progress` is stopped.
/// @param items what to sort; overwritten
/// @param sorted where to, of the same length
void sort_by_highest_30_bits(std::span<std::uint64_t> items, std::span<std::uint64_t> sorted,
                             unsigned threads, Progress& progress);

}  // namespace relight
