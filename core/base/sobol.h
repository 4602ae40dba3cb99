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
    x = __builtin_bswap32(x);
    x = ((x & 0x0f0f0f0fU) << 4U) | ((x & 0xf0f0f0f0U) >> 4U);
    x = ((x & 0x33333333U) << 2U) | ((x & 0xccccccccU) >> 2U);
    return ((x & 0x55555555U) << 1U) | ((x & 0xaaaaaaaaU) >> 1U);
}

/// The same permutation of numbers whose bits are reversed: in which every bit is flipped by a hash
/// of the bits below it. Laine & Karras 2011, with the constants of Burley 2020.
constexpr std::uint32_t scramble_reversed(std::uint32_t x, std::uint32_t seed)
{
    x += seed;
    x ^= x * 0x6c50b47cU;
    x ^= x * 0xb82f1e52U;
    x ^= x * 0xc7afe638U;
    x ^= x * 0x8d22f6e6U;
    return x;
}

/// A random permutation in which every bit is flipped by a hash of the bits above it: Owen's
/// nested uniform scramble.
constexpr std::uint32_t owen_scramble(std::uint32_t x, std::uint32_t seed)
{
    return reverse_bits(scramble_reversed(reverse_bits(x), seed));
}

/// Second coordinate of Sobol's sequence (the first is reverse_bits), its bits reversed: the Pascal
/// matrix mod 2. Binomial (k, j) is odd where k has every bit of j (Lucas), so bit j is the sum of
/// the bits k above it in that order, taken one binary digit of k and j after the other.
constexpr std::uint32_t second_reversed(std::uint32_t index)
{
    index ^= (index >> 1U) & 0x55555555U;
    index ^= (index >> 2U) & 0x33333333U;
    index ^= (index >> 4U) & 0x0f0f0f0fU;
    index ^= (index >> 8U) & 0x00ff00ffU;
    return index ^ index >> 16U;
}

/// A hash that loses nothing of x.   Wellons 2018 ("lowbias32")
constexpr std::uint32_t mix(std::uint32_t x)
{
    x = (x ^ x >> 16U) * 0x7feb352dU;
    x = (x ^ x >> 15U) * 0x846ca68bU;
    return x ^ x >> 16U;
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
                       std::uint32_t replicate)
        : key_(sobol::mix(sobol::mix(sobol::mix(0, seed), item), light)), replicate_(replicate)
    {
    }

    /// Another replicate of the same.
    constexpr Sequence replicate(std::uint32_t number) const
    {
        Sequence other = *this;
        other.replicate_ = number;
        return other;
    }

    /// The `sample`-th point of the `pair`-th pair of dimensions. 32-bit sums and products alone,
    /// which compilers vectorise.
    constexpr Sample2 at(std::uint32_t sample, std::uint32_t pair) const
    {
        const auto low = static_cast<std::uint32_t>(key_);
        const auto high = static_cast<std::uint32_t>(key_ >> 32U);
        constexpr std::uint32_t apart = 0x9e3779b9U, apart_too = 0x85ebca6bU;  // odd
        const std::uint32_t seed =
            sobol::mix(sobol::mix(low + replicate_ * apart) ^ (high + pair * apart_too));
        // An Owen scramble of the index permutes the points and keeps every power-of-two prefix an
        // aligned block of the sequence: a net.
        const std::uint32_t index = sobol::owen_scramble(sample, seed);
        const auto coordinate = [](std::uint32_t reversed, std::uint32_t own_seed) {
            const std::uint32_t x =
                sobol::reverse_bits(sobol::scramble_reversed(reversed, own_seed));
            // Signed, since SSE and AVX2 convert nothing else to double.
            const auto centred = static_cast<std::int32_t>(x ^ 0x80000000U);
            return (centred + (0x1p31 + 0.5)) * 0x1p-32;
        };
        return {coordinate(index, sobol::mix(seed + 1U)),
                coordinate(sobol::second_reversed(index), sobol::mix(seed + 2U))};
    }

  private:
    std::uint64_t key_;
    std::uint32_t replicate_;
};

}  // namespace relight
