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

/// Runs `loop` (a lambda around a loop without branches and calls, which compilers turn into
/// vectors) as compiled for the widest vectors that this processor has. For sources compiled with
/// -ffp-contract=off: then every processor has the same bits, and they are those of the scalar
/// functions that the loop inlines.
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

template <class Loop>
void in_vectors(const Loop& loop)
{
    static const auto fastest = [] {
#ifdef __x86_64__
        if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
            __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw")) {
            return run_avx512<Loop>;
        }
        if (__builtin_cpu_supports("avx2")) { return run_avx2<Loop>; }
#endif
        return run_plain<Loop>;
    }();
    fastest(loop);
}

}  // namespace relight
