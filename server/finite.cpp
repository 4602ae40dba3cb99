#include "server/finite.h"

#include <atomic>
#include <bit>
#include <limits>

#include "core/base/parallel.h"

// CMakeLists.txt has this file optimised for vectors.

namespace relight {

std::size_t clamp_to_finite(std::span<Rgbf> values, unsigned threads)
{
    constexpr std::size_t block = 1 << 15;
    Progress to_the_end;
    std::atomic<std::size_t> clamped{0};
    parallel_for(
        values.size(), block, threads, to_the_end, [&](std::size_t begin, std::size_t end) {
            // The usual case first, without a branch and in one loop, which becomes vectors: the
            // exponent of none is all ones.
            std::uint32_t beyond = 0;
            const float* const bands = values[begin].data();
            for (std::size_t i = 0; i < 3 * (end - begin); ++i) {
                beyond |= (std::bit_cast<std::uint32_t>(bands[i]) & 0x7fffffffU) + 0x00800000U;
            }
            if ((beyond & 0x80000000U) == 0) { return; }
            for (std::size_t v = begin; v < end; ++v) {
                for (float& band : values[v]) {
                    if (band <= std::numeric_limits<float>::max()) { continue; }
                    band = std::numeric_limits<float>::max();
                    ++clamped;
                }
            }
        });
    return clamped;
}

}  // namespace relight
