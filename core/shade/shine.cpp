// The radiance of vertices from delta lights and from what was drawn, all lights in one pass: what
// is a vertex' own is read and formed once.
#include <algorithm>

#include "core/shade/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/shade/shine.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
//
#include <hwy/contrib/math/math-inl.h>
//
#include "core/shade/face-inl.h"
#include "core/shade/models-inl.h"

HWY_BEFORE_NAMESPACE();
namespace relight::kernel::HWY_NAMESPACE {
namespace {

// A vector of floats is rounded from two of doubles, but without SIMD from one.
constexpr bool has_high = HWY_TARGET != HWY_SCALAR;

HWY_INLINE Float joined(Double low, [[maybe_unused]] Double high)
{
    const Halves d;
#if HWY_TARGET == HWY_SCALAR
    return hn::DemoteTo(d, low);
#else
    return hn::Combine(Floats(), hn::DemoteTo(d, high), hn::DemoteTo(d, low));
#endif
}

template <bool is_high>
HWY_INLINE Double half(Float x)
{
    const Doubles d;
#if HWY_TARGET != HWY_SCALAR
    if constexpr (is_high) { return hn::PromoteTo(d, hn::UpperHalf(Halves(), x)); }
#endif
    return hn::PromoteTo(d, hn::LowerHalf(Halves(), x));
}

template <Model model, bool anisotropic>
HWY_INLINE At rounded(const Facing& low, const Facing& high, Float co)
{
    At a;
    a.ci = joined(low.ci, high.ci);
    a.co = co;
    if constexpr (model == Model::Lambert) { return a; }
    if constexpr (model == Model::OrenNayar) {
        a.along = joined(low.along, high.along);
        return a;
    }
    a.h2 = joined(low.h2, high.h2);
    a.hxy2 = hn::Max(joined(low.hxy2, high.hxy2), all(0.0F));
    a.hz = a.ci + co;
    a.cos_d = all(0.5F) * hn::Sqrt(a.h2);
    if constexpr (anisotropic) {
        a.x = joined(low.x, high.x);
        a.y = joined(low.y, high.y);
        a.h_x = joined(low.h_x, high.h_x);
        a.h_y = joined(low.h_y, high.h_y);
    }
    return a;
}

/// f where both directions are above the surface; rounding never makes it negative.
HWY_INLINE Bands above(const At& a, Bands f)
{
    const Float zero = all(0.0F);
    const auto mask = hn::And(a.ci > zero, a.co > zero);
    return {hn::IfThenElseZero(mask, hn::Max(f.r, zero)),
            hn::IfThenElseZero(mask, hn::Max(f.g, zero)),
            hn::IfThenElseZero(mask, hn::Max(f.b, zero))};
}

/// power Lo + f (power E)
template <bool is_high>
HWY_INLINE Vector share(const Share& light, Bands f, Range at)
{
    const Vector power = all(light.power);
    const auto drawn = [&] { return read_rows(light.Lo + 3 * at.v, at.left) * power; };
    if (light.E == nullptr) { return light.Lo != nullptr ? drawn() : Vector{}; }
    const Vector each{half<is_high>(f.r), half<is_high>(f.g), half<is_high>(f.b)};
    const Vector reflected = each * (power * read(light.E + at.v, at.left));
    return light.Lo != nullptr ? drawn() + reflected : reflected;
}

template <bool anisotropic>
HWY_INLINE Seen look_at(const Task& task, const Block& block, Range at)
{
    Seen s = look(*task.view, at);
    s.L = load(block.L, at.i);
    if constexpr (anisotropic) { add_axes(s, block, task, at); }
    return s;
}

constexpr std::size_t together = 4;  // lights; their parts stay in the nearest cache

/// As many vertices as a vector of floats has, from `low_at` on.
template <Model model, bool anisotropic>
HWY_INLINE void shine_at(const Task& task, Block& block, Range low_at)
{
    const std::size_t lanes = has_high ? hn::Lanes(Doubles()) : 0;
    const Range high_at{low_at.i + lanes, low_at.v + lanes,
                        has_high && low_at.left > lanes ? low_at.left - lanes : 0};
    Seen low = look_at<anisotropic>(task, block, low_at);
    Seen high = look_at<anisotropic>(task, block, high_at);
    const Vector rho_low = load(block.rho, low_at.i), rho_high = load(block.rho, high_at.i);
    Outgoing o{};
    o.co = joined(low.cos_o, high.cos_o);
    o.base = {joined(rho_low.x, rho_high.x), joined(rho_low.y, rho_high.y),
              joined(rho_low.z, rho_high.z)};
    if constexpr (anisotropic) {
        o.x = joined(dot(low.wo, low.x), dot(high.wo, high.x));
        o.y = joined(dot(low.wo, low.y), dot(high.wo, high.y));
    }
    keep_aside<model, anisotropic>(*task.reflector, o);
    // A step for several lights, then the next: while one light's roots and quotients are on their
    // way, the processor is at another's.
    for (std::size_t first = 0; first < task.lights.size(); first += together) {
        const auto lights =
            task.lights.subspan(first, std::min(together, task.lights.size() - first));
        At faced[together];
        Bands f[together];
        for (std::size_t l = 0; l < lights.size(); ++l) {
            if (lights[l].E == nullptr) { continue; }
            faced[l] = rounded<model, anisotropic>(
                face<model, anisotropic>(low, lights[l].source, task.both_sides),
                face<model, anisotropic>(high, lights[l].source, task.both_sides), o.co);
        }
        for (std::size_t l = 0; l < lights.size(); ++l) {
            if (lights[l].E == nullptr) { continue; }
            f[l] = above(faced[l], f_of<model, anisotropic>(*task.reflector, o, faced[l]));
        }
        for (std::size_t l = 0; l < lights.size(); ++l) {
            low.L = low.L + share<false>(lights[l], f[l], low_at);
            high.L = high.L + share<true>(lights[l], f[l], high_at);
        }
    }
    if (task.radiance == nullptr) {
        store(low.L, block.L, low_at.i);
        if constexpr (has_high) { store(high.L, block.L, high_at.i); }
        return;
    }
    write_rows(low.L, task.radiance + 3 * low_at.v, low_at.left);
    write_rows(high.L, task.radiance + 3 * high_at.v, high_at.left);
}

template <Model model, bool anisotropic>
void shine_as(const Task& task, Block& block, std::size_t begin, std::size_t count)
{
    for (std::size_t i = 0; i < count; i += hn::Lanes(Floats())) {
        shine_at<model, anisotropic>(task, block, {i, begin + i, count - i});
    }
}

template <Model model>
void shine_by(const Task& task, Block& block, std::size_t begin, std::size_t count)
{
    task.reflector->anisotropic ? shine_as<model, true>(task, block, begin, count)
                                : shine_as<model, false>(task, block, begin, count);
}

void shine_any(const Task& task, Block& block, std::size_t begin, std::size_t count)
{
    switch (task.reflector->model) {
        case Model::Lambert:
            return shine_as<Model::Lambert, false>(task, block, begin, count);
        case Model::OrenNayar:
            return shine_as<Model::OrenNayar, false>(task, block, begin, count);
        case Model::Beckmann:
            return shine_by<Model::Beckmann>(task, block, begin, count);
        case Model::Ggx:
            return shine_by<Model::Ggx>(task, block, begin, count);
        case Model::Gtr:
            return shine_as<Model::Gtr, false>(task, block, begin, count);
        case Model::Principled:
            return shine_by<Model::Principled>(task, block, begin, count);
        case Model::MetallicRoughness:
            return shine_by<Model::MetallicRoughness>(task, block, begin, count);
    }
}

}  // namespace
}  // namespace relight::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relight::kernel {

HWY_EXPORT(shine_any);

void shine(Block& block, const Task& task, std::size_t begin, std::size_t count)
{
    HWY_DYNAMIC_DISPATCH(shine_any)(task, block, begin, count);
}

}  // namespace relight::kernel
#endif
