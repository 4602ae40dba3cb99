#pragma once

#include <cstdint>
#include <initializer_list>

namespace relight {

/// A uniform number in [0, 1) that is a function of its arguments alone, never of a thread or of
/// what was drawn before (splitmix64 finaliser over each argument in turn; Steele et al. 2014).
inline double uniform(std::uint64_t seed, std::uint64_t item, std::uint64_t sample,
                      std::uint64_t dimension)
{
    std::uint64_t h = 0;
    for (const std::uint64_t x : {seed, item, sample, dimension}) {
        h = (h ^ x) + 0x9e3779b97f4a7c15ULL;
        h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9ULL;
        h = (h ^ (h >> 27)) * 0x94d049bb133111ebULL;
        h ^= h >> 31;
    }
    return static_cast<double>(h >> 11) * 0x1p-53;
}

}  // namespace relight
