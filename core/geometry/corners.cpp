// Compiled once for each instruction set (foreach_target.h includes this file again) and without
// contraction to fused multiply-adds, so that every one of them rounds alike.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/geometry/corners.cpp"
#include "core/geometry/corners.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <numbers>

HWY_BEFORE_NAMESPACE();
namespace relight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Lanes = hn::ScalableTag<double>;
using Reals = hn::Vec<Lanes>;

struct Vectors {
    Reals x, y, z;
};

HWY_INLINE Vectors load(const std::array<TriangleBatch::Row<double>, 3>& rows, std::size_t i)
{
    const Lanes d;
    return {hn::LoadU(d, &rows[0][i]), hn::LoadU(d, &rows[1][i]), hn::LoadU(d, &rows[2][i])};
}

HWY_INLINE Vectors difference(const Vectors& a, const Vectors& b)
{
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}

// As vec.h: the same sums in the same order.
HWY_INLINE Reals dot(const Vectors& a, const Vectors& b)
{
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}

HWY_INLINE Vectors cross(const Vectors& a, const Vectors& b)
{
    return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(a.z, b.y)),
            hn::Sub(hn::Mul(a.z, b.x), hn::Mul(a.x, b.z)),
            hn::Sub(hn::Mul(a.x, b.y), hn::Mul(a.y, b.x))};
}

/// (atan(t) / t - 1) / t^2 of z = t^2, |t| <= tan(pi/8): Chebyshev fit of degree 10 (mpmath's
/// chebyfit); atan(t) is within 6e-18 of its size, before rounding.
HWY_INLINE Reals atan_tail(Reals z)
{
    constexpr std::array<double, 11> coefficients{
        -0.01917688711906226, 0.03923165829558719, -0.0508544973794026,  0.0585814891280221,
        -0.06664511447381948, 0.07692183190826087, -0.09090904578123903, 0.11111111015256361,
        -0.14285714284666542, 0.1999999999999552,  -0.3333333333333333};
    const Lanes d;
    Reals sum = hn::Set(d, coefficients[0]);
    for (std::size_t k = 1; k < coefficients.size(); ++k) {
        sum = hn::Add(hn::Mul(sum, z), hn::Set(d, coefficients[k]));
    }
    return sum;
}

/// atan2(y, x), y > 0. With lo / hi the smaller of y and |x| over the larger, its arctangent is
/// atan(lo / hi), or pi/4 + atan((lo - hi) / (lo + hi)) beyond pi/8: t stays small with a single
/// division. The octants are put together by signs and one addition.
HWY_INLINE Reals angle(Reals y, Reals x)
{
    constexpr double tan_eighth = std::numbers::sqrt2 - 1.0;  // of pi
    constexpr double quarter = 0.25 * std::numbers::pi;
    const Lanes d;
    const Reals across = hn::Abs(x);
    const Reals lo = hn::Min(y, across), hi = hn::Max(y, across);
    const auto beyond = hn::Gt(lo, hn::Mul(hi, hn::Set(d, tan_eighth)));
    const auto steep = hn::Gt(y, across);
    const auto obtuse = hn::Lt(x, hn::Zero(d));
    const Reals t = hn::Div(hn::IfThenElse(beyond, hn::Sub(lo, hi), lo),
                            hn::IfThenElse(beyond, hn::Add(lo, hi), hi));
    const Reals z = hn::Mul(t, t);
    const Reals octant = hn::Add(t, hn::Mul(hn::Mul(t, z), atan_tail(z)));
    Reals whole = hn::IfThenElseZero(beyond, hn::Set(d, quarter));
    whole = hn::IfThenElse(steep, hn::Sub(hn::Set(d, 2.0 * quarter), whole), whole);
    whole = hn::IfThenElse(obtuse, hn::Sub(hn::Set(d, 4.0 * quarter), whole), whole);
    const auto backward = hn::Xor(hn::VecFromMask(d, steep), hn::VecFromMask(d, obtuse));
    const Reals sign = hn::And(backward, hn::Set(d, -0.0));
    return hn::Add(whole, hn::Xor(octant, sign));
}

void measure(TriangleBatch& batch)
{
    const Lanes d;
    const Vectors centre{hn::Set(d, batch.centre.x), hn::Set(d, batch.centre.y),
                         hn::Set(d, batch.centre.z)};
    const Reals rounding = hn::Set(d, 1e-14);
    const Reals none = hn::Set(d, TriangleBatch::none);
    for (std::size_t i = 0; i < TriangleBatch::size; i += hn::Lanes(d)) {
        const std::array<Vectors, 3> p{load(batch.corner[0], i), load(batch.corner[1], i),
                                       load(batch.corner[2], i)};
        const std::array<Vectors, 3> edge{difference(p[1], p[0]), difference(p[2], p[1]),
                                          difference(p[0], p[2])};
        const Vectors normal = cross(edge[0], difference(p[2], p[0]));
        const std::array<Reals, 3> squared{dot(edge[0], edge[0]), dot(edge[1], edge[1]),
                                           dot(edge[2], edge[2])};
        const Reals longest = hn::Max(hn::Max(squared[0], squared[1]), squared[2]);
        const Reals area2 = hn::Sqrt(dot(normal, normal));
        const auto proper = hn::Gt(area2, hn::Mul(rounding, longest));
        const Reals inverse = hn::Div(hn::Set(d, 1.0), area2);
        hn::StoreU(normal.x, d, &batch.doubled_area[0][i]);
        hn::StoreU(normal.y, d, &batch.doubled_area[1][i]);
        hn::StoreU(normal.z, d, &batch.doubled_area[2][i]);
        hn::StoreU(hn::IfThenElseZero(proper, area2), d, &batch.area2[i]);
        hn::StoreU(hn::IfThenElseZero(proper, dot(difference(p[0], centre), normal)), d,
                   &batch.volume6[i]);
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t before = (k + 2) % 3;
            const Reals cosine = hn::Neg(dot(edge[k], edge[before]));  // times the edges' lengths
            const Reals weight = hn::Mul(angle(area2, cosine), inverse);
            hn::StoreU(hn::IfThenElseZero(proper, weight), d, &batch.weight[k][i]);
            hn::StoreU(hn::IfThenElse(proper, hn::Min(squared[k], squared[before]), none), d,
                       &batch.shorter2[k][i]);
        }
    }
}

}  // namespace
}  // namespace relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relight {

HWY_EXPORT(measure);

void measure(TriangleBatch& batch)
{
    HWY_DYNAMIC_DISPATCH(measure)(batch);
}

}  // namespace relight
#endif
