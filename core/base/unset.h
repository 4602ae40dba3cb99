#pragma once

#include <memory>
#include <utility>
#include <vector>

namespace relight {

/// Leaves new elements as memory holds them, where std::allocator would write zeros.
template <class T>
struct Unset : std::allocator<T> {
    template <class U, class... Values>
    void construct(U* at, Values&&... values)
    {
        if constexpr (sizeof...(Values) == 0) {
            ::new (static_cast<void*>(at)) U;
        } else {
            std::construct_at(at, std::forward<Values>(values)...);
        }
    }
};

/// For long arrays of which every element is written next, by many threads: zeros would take one
/// thread as long again, and fresh memory would be asked of the system by that thread alone.
template <class T>
using UnsetVector = std::vector<T, Unset<T>>;

}  // namespace relight
