#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/base/progress.h"

namespace relight {

/// Asks the system to give this memory, not yet touched, in huge pages: a page fault for each 4 KiB
/// costs more than what is then done with them. It may well decline.
void ask_for_huge_pages(void* memory, std::size_t bytes);

/// `count` times this value; fewer if `progress` was stopped, which it asks every few MiB.
template <class T>
std::vector<T> filled(std::size_t count, const Progress& progress, const T& value = {})
{
    constexpr std::size_t piece = (std::size_t{1} << 22) / sizeof(T);
    std::vector<T> values;
    values.reserve(count);
    ask_for_huge_pages(values.data(), count * sizeof(T));
    while (values.size() < count && !progress.stopped()) {
        values.resize(std::min(count, values.size() + piece), value);
    }
    return values;
}

}  // namespace relight
