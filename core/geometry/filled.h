#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/base/progress.h"

namespace relight {

/// `count` times this value; fewer if `progress` was stopped, which it asks every few MiB.
template <class T>
std::vector<T> filled(std::size_t count, const Progress& progress, const T& value = {})
{
    constexpr std::size_t piece = (std::size_t{1} << 22) / sizeof(T);
    std::vector<T> values;
    values.reserve(count);
    while (values.size() < count && !progress.stopped()) {
        values.resize(std::min(count, values.size() + piece), value);
    }
    return values;
}

}  // namespace relight
