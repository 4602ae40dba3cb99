// Where vertices are seen from and lit from: everything that is formed in double.
#include <cstring>

#include "core/shade/kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/shade/face.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relight::kernel::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::ScalableTag<double>;
using Floats = hn::Rebind<float, Doubles>;  // as many
using Double = hn::Vec<Doubles>;

struct Vector {
    Double x, y, z;
};

HWY_INLINE Vector load(const double (&from)[3][block_size], std::size_t i)
{
    const Doubles d;
    return {hn::Load(d, from[0] + i), hn::Load(d, from[1] + i), hn::Load(d, from[2] + i)};
}

HWY_INLINE void store(Vector v, double (&to)[3][block_size], std::size_t i)
{
    const Doubles d;
    hn::Store(v.x, d, to[0] + i);
    hn::Store(v.y, d, to[1] + i);
    hn::Store(v.z, d, to[2] + i);
}

HWY_INLINE Vector all(const double (&v)[3])
{
    const Doubles d;
    return {hn::Set(d, v[0]), hn::Set(d, v[1]), hn::Set(d, v[2])};
}

HWY_INLINE Vector operator-(Vector a, Vector b)
{
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}

HWY_INLINE Double dot(Vector a, Vector b)
{
    return hn::MulAdd(a.z, b.z, hn::MulAdd(a.y, b.y, a.x * b.x));
}

/// a + b s
HWY_INLINE Vector plus(Vector a, Vector b, Double s)
{
    return {hn::MulAdd(b.x, s, a.x), hn::MulAdd(b.y, s, a.y), hn::MulAdd(b.z, s, a.z)};
}

/// The first `count` of rows of three, the rest 0.
HWY_INLINE Vector load_rows(const double* rows, std::size_t count)
{
    const Doubles d;
    Vector v;
    if (count >= hn::Lanes(d)) {
        hn::LoadInterleaved3(d, rows, v.x, v.y, v.z);
    } else {
        HWY_ALIGN double tail[3 * hn::MaxLanes(Doubles())] = {};
        std::memcpy(tail, rows, 3 * count * sizeof(double));
        hn::LoadInterleaved3(d, tail, v.x, v.y, v.z);
    }
    return v;
}

/// x^(-1/2), to some 1e-15 of it, with neither root nor quotient: halving the exponent is a first
/// guess within 3.5 %, and the series of (1 - e)^(-1/2), e = 1 - x y^2, mends it. Of 0 it is large,
/// but a number.
HWY_INLINE Double inverse_root(Double x)
{
    const Doubles d;
    const hn::RebindToUnsigned<Doubles> bits;
    const auto halved = hn::ShiftRight<1>(hn::BitCast(bits, x));
    Double y = hn::BitCast(d, hn::Set(bits, 0x5FE6EB50C7B537A9ULL) - halved);
    const auto c1 = hn::Set(d, 0.5), c2 = hn::Set(d, 0.375), c3 = hn::Set(d, 0.3125);
    const Double one = hn::Set(d, 1.0);
    const Double e = hn::NegMulAdd(x * y, y, one);
    y = hn::MulAdd(y * e, hn::MulAdd(e, hn::MulAdd(e, c3, c2), c1), y);
    const Double less = hn::NegMulAdd(x * y, y, one);
    return hn::MulAdd(y * less, hn::MulAdd(less, c2, c1), y);
}

void look_at(Block& block, const Viewer& viewer, const double* positions, const double* normals,
             std::size_t begin)
{
    const Doubles d;
    const std::size_t lanes = hn::Lanes(d);
    const Double zero = hn::Zero(d), one = hn::Set(d, 1.0);
    const Vector at = all(viewer.at);
    for (std::size_t i = 0; i < block.count; i += lanes) {
        const std::size_t left = block.count - i;
        const Vector p = load_rows(positions + 3 * (begin + i), left);
        Vector n = load_rows(normals + 3 * (begin + i), left);
        Vector wo{zero, zero, zero};
        Double cos_o = hn::IfThenElseZero(dot(n, n) > zero, one);
        if (viewer.place != Viewer::Place::AlongNormal) {
            const bool is_point = viewer.place == Viewer::Place::Point;
            const Vector to_viewer = is_point ? at - p : at;
            const Double inverse = is_point ? inverse_root(dot(to_viewer, to_viewer)) : one;
            Double facing = dot(n, to_viewer);
            if (viewer.two_sided) {
                const Double side = hn::And(facing, hn::SignBit(d));
                n = {hn::Xor(n.x, side), hn::Xor(n.y, side), hn::Xor(n.z, side)};
                facing = hn::Abs(facing);
            }
            const auto seen = facing > zero;
            cos_o = hn::IfThenElseZero(seen, facing * inverse);
            const Vector across = plus(to_viewer, n, hn::Neg(facing));
            wo = {hn::IfThenElseZero(seen, across.x * inverse),
                  hn::IfThenElseZero(seen, across.y * inverse),
                  hn::IfThenElseZero(seen, across.z * inverse)};
        }
        store(p, block.p, i);
        store(n, block.n, i);
        store(wo, block.wo, i);
        hn::Store(cos_o, d, block.cos_o + i);
    }
}

void mask(Block& block)
{
    const Doubles d;
    const std::size_t lanes = hn::Lanes(d);
    for (std::size_t i = 0; i < block.count; i += lanes) {
        const auto seen = hn::Load(d, block.cos_o + i) > hn::Zero(d);
        const Vector rho = load(block.rho, i);
        store({hn::IfThenElseZero(seen, rho.x), hn::IfThenElseZero(seen, rho.y),
               hn::IfThenElseZero(seen, rho.z)},
              block.rho, i);
    }
}

HWY_INLINE void round(Double v, float* to)
{
    const Floats f;
    hn::Store(hn::DemoteTo(f, v), f, to);
}

void round_outgoing(Block& block, bool anisotropic)
{
    const Doubles d;
    const std::size_t lanes = hn::Lanes(d);
    for (std::size_t i = 0; i < block.count; i += lanes) {
        round(hn::Load(d, block.cos_o + i), block.co + i);
        const Vector rho = load(block.rho, i);
        round(rho.x, block.base[0] + i);
        round(rho.y, block.base[1] + i);
        round(rho.z, block.base[2] + i);
        if (!anisotropic) { continue; }
        const Vector wo = load(block.wo, i);
        round(dot(wo, load(block.x, i)), block.wo_x + i);
        round(dot(wo, load(block.y, i)), block.wo_y + i);
    }
}

template <bool is_direction, Across across>
void face_source(Block& block, const Source& source, bool both_sides)
{
    const Doubles d;
    const std::size_t lanes = hn::Lanes(d);
    const Vector at = all(source.at);
    const auto no_sign = both_sides ? hn::SignBit(d) : hn::Zero(d);
    for (std::size_t i = 0; i < block.count; i += lanes) {
        const Vector n = load(block.n, i);
        const Vector wo = load(block.wo, i);
        Vector to_light = at;
        Double inverse = hn::Set(d, 1.0);
        if constexpr (!is_direction) {
            to_light = at - load(block.p, i);
            inverse = inverse_root(dot(to_light, to_light));
        }
        const Double facing = dot(n, to_light);
        const Vector off_normal = plus(to_light, n, hn::Neg(facing));
        const Double cos_i = hn::AndNot(no_sign, facing * inverse);
        round(cos_i, block.ci + i);
        if constexpr (across == Across::Along) {
            round(dot(off_normal, wo) * inverse, block.along + i);
            continue;
        }
        const Vector h = plus(wo, off_normal, inverse);  // less its share along n
        const Double hz = cos_i + hn::Load(d, block.cos_o + i);
        const Double hxy2 = dot(h, h);
        round(hxy2, block.hxy2 + i);
        round(hn::MulAdd(hz, hz, hxy2), block.h2 + i);
        if constexpr (across == Across::Axes) {
            const Vector x = load(block.x, i), y = load(block.y, i);
            round(dot(off_normal, x) * inverse, block.wi_x + i);
            round(dot(off_normal, y) * inverse, block.wi_y + i);
            round(dot(h, x), block.h_x + i);
            round(dot(h, y), block.h_y + i);
        }
    }
}

void face_any(Block& block, const Source& source, bool both_sides, Across across)
{
    switch (across) {
        case Across::Along:
            return source.is_direction
                       ? face_source<true, Across::Along>(block, source, both_sides)
                       : face_source<false, Across::Along>(block, source, both_sides);
        case Across::Half:
            return source.is_direction
                       ? face_source<true, Across::Half>(block, source, both_sides)
                       : face_source<false, Across::Half>(block, source, both_sides);
        case Across::Axes:
            return source.is_direction
                       ? face_source<true, Across::Axes>(block, source, both_sides)
                       : face_source<false, Across::Axes>(block, source, both_sides);
    }
}

HWY_INLINE Double read(const float* from)
{
    return hn::PromoteTo(Doubles(), hn::LoadU(Floats(), from));
}

/// L += power Lo + f (power E). Nothing is fused: explain sums the same in plain C++.
void add(Block& block, const double (&power)[3], const float* Lo, const float* E)
{
    const Doubles d;
    const Floats floats;
    const std::size_t lanes = hn::Lanes(d);
    const Vector each = all(power);
    for (std::size_t i = 0; i < block.count; i += lanes) {
        const std::size_t left = block.count - i;
        Vector sum{hn::Zero(d), hn::Zero(d), hn::Zero(d)};
        if (Lo != nullptr) {
            HWY_ALIGN float tail[3 * hn::MaxLanes(Doubles())] = {};
            const float* rows = Lo + 3 * i;
            if (left < lanes) {
                std::memcpy(tail, rows, 3 * left * sizeof(float));
                rows = tail;
            }
            hn::Vec<Floats> r, g, b;
            hn::LoadInterleaved3(floats, rows, r, g, b);
            sum = {hn::PromoteTo(d, r) * each.x, hn::PromoteTo(d, g) * each.y,
                   hn::PromoteTo(d, b) * each.z};
        }
        if (E != nullptr) {
            HWY_ALIGN float tail[hn::MaxLanes(Doubles())] = {};
            const float* values = E + i;
            if (left < lanes) {
                std::memcpy(tail, values, left * sizeof(float));
                values = tail;
            }
            const Double e = read(values);
            const Vector f{read(block.f[0] + i), read(block.f[1] + i), read(block.f[2] + i)};
            sum = {sum.x + f.x * (each.x * e), sum.y + f.y * (each.y * e),
                   sum.z + f.z * (each.z * e)};
        }
        const Vector L = load(block.L, i);
        store({L.x + sum.x, L.y + sum.y, L.z + sum.z}, block.L, i);
    }
}

void store_rows(const Block& block, float* radiance)
{
    const Floats floats;
    const std::size_t lanes = hn::Lanes(floats);
    for (std::size_t i = 0; i < block.count; i += lanes) {
        const Vector L = load(block.L, i);
        const auto r = hn::DemoteTo(floats, L.x), g = hn::DemoteTo(floats, L.y),
                   b = hn::DemoteTo(floats, L.z);
        if (block.count - i >= lanes) {
            hn::StoreInterleaved3(r, g, b, floats, radiance + 3 * i);
        } else {
            HWY_ALIGN float tail[3 * hn::MaxLanes(Doubles())];
            hn::StoreInterleaved3(r, g, b, floats, tail);
            std::memcpy(radiance + 3 * i, tail, 3 * (block.count - i) * sizeof(float));
        }
    }
}

}  // namespace
}  // namespace relight::kernel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relight::kernel {

HWY_EXPORT(look_at);
HWY_EXPORT(mask);
HWY_EXPORT(round_outgoing);
HWY_EXPORT(face_any);
HWY_EXPORT(add);
HWY_EXPORT(store_rows);

void look(Block& block, const Viewer& viewer, const double* positions, const double* normals,
          std::size_t begin)
{
    HWY_DYNAMIC_DISPATCH(look_at)(block, viewer, positions, normals, begin);
}

void mask_rho(Block& block)
{
    HWY_DYNAMIC_DISPATCH(mask)(block);
}

void round_wo(Block& block, bool anisotropic)
{
    HWY_DYNAMIC_DISPATCH(round_outgoing)(block, anisotropic);
}

void face(Block& block, const Source& source, bool both_sides, Across across)
{
    HWY_DYNAMIC_DISPATCH(face_any)(block, source, both_sides, across);
}

void add_light(Block& block, const double (&power)[3], const float* Lo, const float* E,
               std::size_t begin)
{
    HWY_DYNAMIC_DISPATCH(add)
    (block, power, Lo == nullptr ? nullptr : Lo + 3 * begin, E == nullptr ? nullptr : E + begin);
}

void store(const Block& block, float* radiance, std::size_t begin)
{
    HWY_DYNAMIC_DISPATCH(store_rows)(block, radiance + 3 * begin);
}

}  // namespace relight::kernel
#endif
