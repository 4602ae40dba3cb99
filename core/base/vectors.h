#pragma once

#include <bit>
#include <cstdint>

#include "core/base/vec.h"

/// Before a loop: what it writes is not what it reads in another round. (Clang's word for it is an
/// order, and an error where it cannot follow.)
#ifdef __clang__
#define RELIGHT_APART
#else
#define RELIGHT_APART _Pragma("GCC ivdep")
#endif

namespace relight {

/// A condition as 64 bits, all 1 or all 0. In a loop of many choices compilers make branches of
/// bools, and no vectors.
using Mask = std::uint64_t;
constexpr Mask where(bool holds)
{
    return holds ? ~Mask{0} : Mask{0};
}
/// a where the mask holds, else b.
constexpr double choose(Mask first, double a, double b)
{
    const auto other = std::bit_cast<std::uint64_t>(b);
    return std::bit_cast<double>(other ^ (first & (other ^ std::bit_cast<std::uint64_t>(a))));
}
constexpr Vec3 choose(Mask first, Vec3 a, Vec3 b)
{
    return {choose(first, a.x, b.x), choose(first, a.y, b.y), choose(first, a.z, b.z)};
}

/// 1 / sqrt(x) of x > 0 whose square is no less than the least double, within 6e-16 of itself; some
/// number of 0. A bit trick's guess (within 3.5 %) and Newton's steps, each of which squares its
/// error: a quarter of the time of a vector's root and quotient.   Test: Vectors.*
constexpr double inverse_root(double x)
{
    const double half = 0.5 * x;
    auto y = std::bit_cast<double>(0x5fe6eb50c7b537a9U - (std::bit_cast<std::uint64_t>(x) >> 1U));
    y *= 1.5 - half * y * y;
    y *= 1.5 - half * y * y;
    y *= 1.5 - half * y * y;
    return y * (1.5 - half * y * y);
}

template <class Loop>
[[gnu::flatten]] void run_plain(const Loop& loop)
{
    loop();
}

#ifdef __x86_64__
template <class Loop>
[[gnu::flatten, gnu::target("avx2")]] void run_avx2(const Loop& loop)
{
    loop();
}
template <class Loop>
[[gnu::flatten, gnu::target("avx512f,avx512dq,avx512vl,avx512bw")]] void run_avx512(
    const Loop& loop)
{
    loop();
}
#endif

/// Sets of vectors that loops are compiled for, each wider than the one before.
enum class VectorSet { Plain, Avx2, Avx512 };

/// The widest that this processor has.
inline VectorSet widest_vectors()
{
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw")) {
        return VectorSet::Avx512;
    }
    if (__builtin_cpu_supports("avx2")) { return VectorSet::Avx2; }
#endif
    return VectorSet::Plain;
}

/// The set that in_vectors() takes: the widest. Tests have it take a narrower one, while no loop
/// runs.   Test: Vectors.*
inline VectorSet& vectors_taken()
{
    static VectorSet set = widest_vectors();
    return set;
}

/// Runs `loop` (a lambda around a loop without branches and calls, which compilers turn into
/// vectors) as compiled for the widest vectors that this processor has. For sources compiled with
/// -ffp-contract=off: then every processor has the same bits, and they are those of the scalar
/// functions that the loop inlines.
template <class Loop>
void in_vectors(const Loop& loop)
{
#ifdef __x86_64__
    switch (vectors_taken()) {
        case VectorSet::Avx512:
            return run_avx512(loop);
        case VectorSet::Avx2:
            return run_avx2(loop);
        case VectorSet::Plain:
            break;
    }
#endif
    run_plain(loop);
}

}  // namespace relight
