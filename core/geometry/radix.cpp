#include "core/geometry/radix.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace relight {
namespace {

constexpr unsigned digit_bits = 10;  // three passes; eight bits take four, and longer
constexpr std::size_t digits = std::size_t{1} << digit_bits;
constexpr std::size_t least_block = 65'536;  // 0.3 ms
constexpr std::size_t most_blocks = 1024;    // each has its own counts: 8 kB

/// One pass of a radix sort, of the digit that begins at `bit`.
void sort_by_digit(unsigned bit, std::span<const std::uint64_t> from, std::span<std::uint64_t> to,
                   unsigned threads, Progress& progress)
{
    const auto digit_of = [bit](std::uint64_t item) {
        return static_cast<std::size_t>(item >> bit) % digits;
    };
    const std::size_t block = std::max(least_block, from.size() / most_blocks + 1);
    std::vector<std::array<std::size_t, digits>> places((from.size() + block - 1) / block);
    parallel_for(from.size(), block, threads, progress, [&](std::size_t begin, std::size_t end) {
        auto& counts = places[begin / block];
        for (std::size_t i = begin; i < end; ++i) { ++counts[digit_of(from[i])]; }
    });
    std::size_t before = 0;
    for (std::size_t d = 0; d < digits; ++d) {
        for (auto& counts : places) { before += std::exchange(counts[d], before); }
    }
    parallel_for(from.size(), block, threads, progress, [&](std::size_t begin, std::size_t end) {
        auto& place = places[begin / block];
        for (std::size_t i = begin; i < end; ++i) { to[place[digit_of(from[i])]++] = from[i]; }
    });
}

}  // namespace

void sort_by_highest_30_bits(std::span<std::uint64_t> items, std::span<std::uint64_t> sorted,
                             unsigned threads, Progress& progress)
{
    constexpr unsigned least = 64 - 3 * digit_bits;
    sort_by_digit(least, items, sorted, threads, progress);
    sort_by_digit(least + digit_bits, sorted, items, threads, progress);
    sort_by_digit(least + 2 * digit_bits, items, sorted, threads, progress);
}

}  // namespace relight
