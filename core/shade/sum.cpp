// Relighting from columns: E, its error, and what a Lambertian surface sends out, in one pass.
#include <cstring>
#include <numbers>

#include "core/shade/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/shade/sum.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relight::kernel::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::ScalableTag<double>;
using Floats = hn::Rebind<float, Doubles>;  // as many
using Double = hn::Vec<Doubles>;
constexpr std::size_t most_lanes = hn::MaxLanes(Doubles());

struct Color {
    Double r, g, b;
};
HWY_INLINE Color operator+(Color a, Color b)
{
    return {a.r + b.r, a.g + b.g, a.b + b.b};
}
HWY_INLINE Color operator*(Color a, Color b)
{
    return {a.r * b.r, a.g * b.g, a.b * b.b};
}

/// The `bands` values of each vertex from v on; `is_tail`: only of the first `left`.
template <bool is_tail>
HWY_INLINE Color read(const float* values, unsigned bands, std::size_t v, std::size_t left)
{
    const Doubles d;
    const Floats floats;
    const float* from = values + v * bands;
    HWY_ALIGN float tail[3 * most_lanes] = {};
    if constexpr (is_tail) {
        std::memcpy(tail, from, left * bands * sizeof(float));
        from = tail;
    }
    if (bands == 1) {
        const Double one = hn::PromoteTo(d, hn::LoadU(floats, from));
        return {one, one, one};
    }
    hn::Vec<Floats> r, g, b;
    hn::LoadInterleaved3(floats, from, r, g, b);
    return {hn::PromoteTo(d, r), hn::PromoteTo(d, g), hn::PromoteTo(d, b)};
}

template <bool is_tail>
HWY_INLINE void write(Color c, float* values, std::size_t v, std::size_t left)
{
    const Floats floats;
    const auto r = hn::DemoteTo(floats, c.r), g = hn::DemoteTo(floats, c.g),
               b = hn::DemoteTo(floats, c.b);
    if constexpr (is_tail) {
        HWY_ALIGN float tail[3 * most_lanes];
        hn::StoreInterleaved3(r, g, b, floats, tail);
        std::memcpy(values + 3 * v, tail, 3 * left * sizeof(float));
    } else {
        hn::StoreInterleaved3(r, g, b, floats, values + 3 * v);
    }
}

template <bool is_tail>
HWY_INLINE void add_at(const Sums& sums, std::size_t begin, std::size_t v, std::size_t left)
{
    const Doubles d;
    const Double zero = hn::Zero(d);
    Color E{zero, zero, zero}, variance = E, L = E, rho = E;
    if (sums.radiance != nullptr) {
        const std::size_t i = v - begin;  // rho is a block's, whole vectors long
        rho = {hn::LoadU(d, sums.rho[0] + i), hn::LoadU(d, sums.rho[1] + i),
               hn::LoadU(d, sums.rho[2] + i)};
    }
    const Double inv_pi = hn::Set(d, std::numbers::inv_pi);
    for (std::size_t l = 0; l < sums.count; ++l) {
        const Summand& light = sums.lights[l];
        const Color power{hn::Set(d, light.power[0]), hn::Set(d, light.power[1]),
                          hn::Set(d, light.power[2])};
        Color one = read<is_tail>(light.E, light.E_bands, v, left);
        if (light.bounced != nullptr) { one = one + read<is_tail>(light.bounced, 3, v, left); }
        one = one * power;
        if (light.per_light != nullptr) { write<is_tail>(one, light.per_light, v, left); }
        E = E + one;
        if (sums.radiance != nullptr) { L = L + rho * one * Color{inv_pi, inv_pi, inv_pi}; }
        if (sums.error != nullptr && light.error != nullptr) {
            const Color error = read<is_tail>(light.error, light.error_bands, v, left) * power;
            variance = variance + error * error;  // lights draw independent samples
        }
    }
    if (sums.E != nullptr) { write<is_tail>(E, sums.E, v, left); }
    if (sums.radiance != nullptr) { write<is_tail>(L, sums.radiance, v, left); }
    if (sums.error != nullptr) {
        write<is_tail>({hn::Sqrt(variance.r), hn::Sqrt(variance.g), hn::Sqrt(variance.b)},
                       sums.error, v, left);
    }
}

void add(const Sums& sums, std::size_t begin, std::size_t end)
{
    const std::size_t lanes = hn::Lanes(Doubles());
    std::size_t v = begin;
    for (; v + lanes <= end; v += lanes) { add_at<false>(sums, begin, v, lanes); }
    if (v < end) { add_at<true>(sums, begin, v, end - v); }
}

}  // namespace
}  // namespace relight::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relight::kernel {

HWY_EXPORT(add);

void add_columns(const Sums& sums, std::size_t begin, std::size_t end)
{
    HWY_DYNAMIC_DISPATCH(add)(sums, begin, end);
}

}  // namespace relight::kernel
#endif
