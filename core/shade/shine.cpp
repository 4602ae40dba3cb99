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

template <Made made>
HWY_INLINE At rounded(const Facing& low, const Facing& high, Float co)
{
    At a;
    a.ci = joined(low.ci, high.ci);
    a.co = co;
    if constexpr (made == Made::OfCosines) { return a; }
    if constexpr (made == Made::OfAlong) {
        a.along = joined(low.along, high.along);
        return a;
    }
    a.hz = a.ci + co;
    a.hxy2 = hn::Max(joined(low.hxy2, high.hxy2), all(0.0F));
    a.h2 = hn::MulAdd(a.hz, a.hz, a.hxy2);
    a.cos_d = all(0.5F) * hn::Sqrt(a.h2);
    if constexpr (made == Made::OfAxes) {
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

template <bool on_axes>
HWY_INLINE Seen look_at(const Task& task, const Block& block, Range at)
{
    Seen s = look(*task.view, at);
    if constexpr (on_axes) { add_axes(s, block, task, at); }
    return s;
}

constexpr std::size_t lights_together = 4;
constexpr std::size_t vectors_together = 4;

/// Vertices and lights that are taken together: one step for all of them, then the next. While the
/// roots and quotients of one are on their way, the processor is at others; what steps hand on
/// stays in the nearest cache.
struct Work {
    std::size_t count;  // vectors of floats
    std::span<const Share> lights;
    Range at[vectors_together];
    Seen low[vectors_together], high[vectors_together];  // halves of each
    Vector L_low[vectors_together], L_high[vectors_together];
    Outgoing outgoing[vectors_together];
    At arriving[lights_together][vectors_together];
    Bands f[lights_together][vectors_together];
};

HWY_INLINE Range high_of(Range low)
{
    const std::size_t lanes = has_high ? hn::Lanes(Doubles()) : 0;
    return {low.i + lanes, low.v + lanes, has_high && low.left > lanes ? low.left - lanes : 0};
}

template <bool on_axes>
HWY_NOINLINE void look_around(const Task& task, const Block& block, Work& w)
{
    for (std::size_t k = 0; k < w.count; ++k) {
        const Range low_at = w.at[k], high_at = high_of(low_at);
        w.low[k] = look_at<on_axes>(task, block, low_at);
        w.high[k] = look_at<on_axes>(task, block, high_at);
        w.L_low[k] = load(block.L, low_at.i);
        w.L_high[k] = load(block.L, high_at.i);
        const Vector rho_low = load(block.rho, low_at.i), rho_high = load(block.rho, high_at.i);
        Outgoing& o = w.outgoing[k];
        o.co = joined(w.low[k].cos_o, w.high[k].cos_o);
        o.base = {joined(rho_low.x, rho_high.x), joined(rho_low.y, rho_high.y),
                  joined(rho_low.z, rho_high.z)};
        if constexpr (on_axes) {
            o.x = joined(w.low[k].wo_x, w.high[k].wo_x);
            o.y = joined(w.low[k].wo_y, w.high[k].wo_y);
        }
    }
}

template <Model model, bool anisotropic>
HWY_NOINLINE void leave(const Reflector& m, Work& w)
{
    for (std::size_t k = 0; k < w.count; ++k) { keep_aside<model, anisotropic>(m, w.outgoing[k]); }
}

template <Made made>
HWY_NOINLINE void arrive(bool both_sides, Work& w)
{
    for (std::size_t l = 0; l < w.lights.size(); ++l) {
        if (w.lights[l].E == nullptr) { continue; }
        const Source source = w.lights[l].source;
        for (std::size_t k = 0; k < w.count; ++k) {
            w.arriving[l][k] =
                rounded<made>(face<made>(w.low[k], source, both_sides),
                              face<made>(w.high[k], source, both_sides), w.outgoing[k].co);
        }
    }
}

template <Model model, bool anisotropic>
HWY_NOINLINE void reflect(const Reflector& m, Work& w)
{
    for (std::size_t l = 0; l < w.lights.size(); ++l) {
        if (w.lights[l].E == nullptr) { continue; }
        for (std::size_t k = 0; k < w.count; ++k) {
            const At& a = w.arriving[l][k];
            w.f[l][k] = above(a, f_of<model, anisotropic>(m, w.outgoing[k], a));
        }
    }
}

template <bool is_high>
HWY_INLINE Vector sum(const Work& w, std::size_t k, Range at, Vector L)
{
    for (std::size_t l = 0; l < w.lights.size(); ++l) {
        L = L + share<is_high>(w.lights[l], w.f[l][k], at);
    }
    return L;
}

HWY_NOINLINE void add_lights(Work& w)
{
    for (std::size_t k = 0; k < w.count; ++k) {
        w.L_low[k] = sum<false>(w, k, w.at[k], w.L_low[k]);
        if constexpr (has_high) { w.L_high[k] = sum<true>(w, k, high_of(w.at[k]), w.L_high[k]); }
    }
}

HWY_NOINLINE void write(const Work& w, Block& block, float* radiance)
{
    const auto write_half = [&](Vector L, Range at) {
        radiance == nullptr ? store(L, block.L, at.i) : write_rows(L, radiance + 3 * at.v, at.left);
    };
    for (std::size_t k = 0; k < w.count; ++k) {
        write_half(w.L_low[k], w.at[k]);
        if constexpr (has_high) { write_half(w.L_high[k], high_of(w.at[k])); }
    }
}

/// The steps that are a model's own.
struct Steps {
    void (*leave)(const Reflector& m, Work& w);
    void (*reflect)(const Reflector& m, Work& w);
};

template <Made made>
HWY_NOINLINE void shine_made(const Task& task, Block& block, std::size_t begin, std::size_t count,
                             const Steps& steps)
{
    Work w;
    for (std::size_t i = 0; i < count;) {
        for (w.count = 0; w.count < vectors_together && i < count; i += hn::Lanes(Floats())) {
            w.at[w.count++] = {i, begin + i, count - i};
        }
        look_around<made == Made::OfAxes>(task, block, w);
        steps.leave(*task.reflector, w);
        for (std::size_t first = 0; first < task.lights.size(); first += lights_together) {
            const std::size_t left = task.lights.size() - first;
            w.lights = task.lights.subspan(first, std::min(left, lights_together));
            arrive<made>(task.both_sides, w);
            steps.reflect(*task.reflector, w);
            add_lights(w);
        }
        write(w, block, task.radiance);
    }
}

template <Model model, bool anisotropic>
void shine_as(const Task& task, Block& block, std::size_t begin, std::size_t count)
{
    shine_made<made<model, anisotropic>>(
        task, block, begin, count, {&leave<model, anisotropic>, &reflect<model, anisotropic>});
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
