#pragma once

#include <cstdint>

namespace relight {

/// A point of the unit square [0, 1)^2.
struct Sample2 {
    double u{}, v{};
};

namespace sobol {

constexpr std::uint32_t reverse_bits(std::uint32_t x)
{
    x = (x << 16U) | (x >> 16U);
    x = ((x & 0x00ff00ffU) << 8U) | ((x & 0xff00ff00U) >> 8U);
    x = ((x & 0x0f0f0f0fU) << 4U) | ((x & 0xf0f0f0f0U) >> 4U);
    x = ((x & 0x33333333U) << 2U) | ((x & 0xccccccccU) >> 2U);
    return ((x & 0x55555555U) << 1U) | ((x & 0xaaaaaaaaU) >> 1U);
}

/// A random permutation in which every bit is flipped by a hash of the bits above it: Owen's
/// nested uniform scramble, in the hashed form of Laine & Karras 2011 with the constants of Burley
/// 2020.
constexpr std::uint32_t owen_scramble(std::uint32_t x, std::uint32_t seed)
{
    x = reverse_bits(x);
    x += seed;
    x ^= x * 0x6c50b47cU;
    x ^= x * 0xb82f1e52U;
    x ^= x * 0xc7afe638U;
    x ^= x * 0x8d22f6e6U;
    return reverse_bits(x);
}

/// Second coordinate of Sobol's sequence (the first is reverse_bits): the Pascal matrix mod 2.
constexpr std::uint32_t second(std::uint32_t index)
{
    std::uint32_t result = 0;
    for (std::uint32_t column = 0x80000000U; index != 0; index >>= 1U) {
        if ((index & 1U) != 0) { result ^= column; }
        column ^= column >> 1U;
    }
    return result;
}

constexpr std::uint64_t mix(std::uint64_t h, std::uint64_t x)
{
    h = (h ^ x) + 0x9e3779b97f4a7c15ULL;
    h = (h ^ (h >> 30U)) * 0xbf58476d1ce4e5b9ULL;
    h = (h ^ (h >> 27U)) * 0x94d049bb133111ebULL;
    return h ^ (h >> 31U);
}

}  // namespace sobol

/// A randomised low-discrepancy sequence of as many dimensions as are asked for: each pair of
/// dimensions is Sobol's (0,2)-sequence, its points in an order and with an Owen scramble of the
/// pair's own (padding; Burley 2020, "Practical hash-based Owen scrambling"). Every power-of-two
/// block of samples is well spread in every pair; each point alone is uniform. A function of its
/// key alone; sequences of different keys are independent.
/// Test: Sobol.*
class Sequence {
  public:
    constexpr Sequence(std::uint64_t seed, std::uint64_t item, std::uint64_t light,
                       std::uint64_t replicate)
        : key_(sobol::mix(sobol::mix(sobol::mix(sobol::mix(0, seed), item), light), replicate))
    {
    }

    /// The `sample`-th point of the `pair`-th pair of dimensions.
    constexpr Sample2 at(std::uint32_t sample, std::uint32_t pair) const
    {
        const std::uint64_t a = sobol::mix(key_, pair);
        const std::uint64_t b = sobol::mix(a, 1);
        const auto low = [](std::uint64_t h) { return static_cast<std::uint32_t>(h); };
        const auto high = [](std::uint64_t h) { return static_cast<std::uint32_t>(h >> 32U); };
        // An Owen scramble of the index permutes the points and keeps every power-of-two prefix an
        // aligned block of the sequence: a net.
        const std::uint32_t index = sobol::owen_scramble(sample, low(a));
        const std::uint32_t x = sobol::owen_scramble(sobol::reverse_bits(index), high(a));
        const std::uint32_t y = sobol::owen_scramble(sobol::second(index), low(b));
        constexpr double unit = 0x1p-32;
        return {(x + 0.5) * unit, (y + 0.5) * unit};
    }

  private:
    std::uint64_t key_;
};

}  // namespace relight
