#pragma once

#include <cstddef>
#include <functional>

#include "core/base/progress.h"

namespace relight {

/// Calls body(begin, end) for consecutive blocks of [0, count) on up to `threads` threads (0: one a
/// core). Blocks are disjoint and cover the range once; which thread runs which block is open, so a
/// body writes only to its own range and results do not depend on the number of threads.
/// Stops between blocks when progress.stopped(). An exception in a body is rethrown here.
/// Worker threads flush denormals.
void parallel_for(std::size_t count, std::size_t block, unsigned threads, Progress& progress,
                  const std::function<void(std::size_t, std::size_t)>& body);

}  // namespace relight
