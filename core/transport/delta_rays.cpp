#include "core/transport/delta_rays.h"

#include <algorithm>

#include "core/light/point_light.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/transport/delta_rays.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Doubles = hn::ScalableTag<double>;
using Floats = hn::Rebind<float, Doubles>;  // as many
using Double = hn::Vec<Doubles>;
using Mask = hn::Mask<Doubles>;
constexpr double infinity = std::numeric_limits<double>::infinity();
static_assert(hn::MaxLanes(Doubles()) <= std::min<std::size_t>(RayFields::spare, 8));  // lanes_of()

HWY_INLINE Double set(double x)
{
    return hn::Set(Doubles(), x);
}

/// Vec3, lane by lane: the same operations in the same order.
struct Vectors {
    Double x, y, z;
};
HWY_INLINE Vectors operator+(Vectors a, Vectors b)
{
    return {hn::Add(a.x, b.x), hn::Add(a.y, b.y), hn::Add(a.z, b.z)};
}
HWY_INLINE Vectors operator-(Vectors a, Vectors b)
{
    return {hn::Sub(a.x, b.x), hn::Sub(a.y, b.y), hn::Sub(a.z, b.z)};
}
HWY_INLINE Vectors operator*(Vectors a, Double s)
{
    return {hn::Mul(a.x, s), hn::Mul(a.y, s), hn::Mul(a.z, s)};
}

/// What many numbers are divided by. A division takes as long as thirty products. Where there are
/// fused ones a quotient is the product with the inverse, corrected twice by its remainder: rounded
/// as the division is (Markstein 1990), but that -0 may turn into 0 and that numbers below 1e-290,
/// whose remainders vanish, lose last bits.
struct Divisor {
    Double d, inverse;
    HWY_INLINE explicit Divisor(Double by) : d(by), inverse(hn::Div(set(1.0), by)) {}
};
HWY_INLINE Double operator/(Double x, const Divisor& by)
{
#if HWY_NATIVE_FMA
    const Double near = hn::Mul(x, by.inverse);
    const Double nearer = hn::MulAdd(hn::NegMulAdd(near, by.d, x), by.inverse, near);
    return hn::MulAdd(hn::NegMulAdd(nearer, by.d, x), by.inverse, nearer);
#else
    return hn::Div(x, by.d);
#endif
}
HWY_INLINE Vectors operator/(Vectors a, const Divisor& by)
{
    return {a.x / by, a.y / by, a.z / by};
}
HWY_INLINE Double dot(Vectors a, Vectors b)
{
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vectors all(Vec3 v)
{
    return {set(v.x), set(v.y), set(v.z)};
}
HWY_INLINE Vectors choose(Mask mask, Vectors yes, Vectors no)
{
    return {hn::IfThenElse(mask, yes.x, no.x), hn::IfThenElse(mask, yes.y, no.y),
            hn::IfThenElse(mask, yes.z, no.z)};
}
HWY_INLINE Vectors read(const double* x, const double* y, const double* z)
{
    const Doubles d;
    constexpr std::size_t ahead = 64;  // in streams so many and so short, processors guess too late
    for (const double* field : {x, y, z}) { hwy::Prefetch(field + ahead); }
    return {hn::LoadU(d, x), hn::LoadU(d, y), hn::LoadU(d, z)};
}

HWY_INLINE void write(Double x, RayFields::Field<double>& to, std::size_t i)
{
    hn::StoreU(x, Doubles(), &to[i]);
}
HWY_INLINE void write(Double x, RayFields::Field<float>& to, std::size_t i)
{
    hn::StoreU(hn::DemoteTo(Floats(), x), Floats(), &to[i]);
}

/// What reaches a vertex of one unit, and whence: Arrival.
struct Arrivals {
    Vectors wi;
    Double distance, per_unit;
    Mask well;  ///< vector code tells the same as scalar
};
HWY_INLINE Arrivals arrive(const DeltaGeometry& light, const double* told, Vectors p)
{
    const Doubles d;
    if (light.distant) {
        return {all(light.wi), set(infinity), set(1.0), hn::FirstN(d, hn::Lanes(d))};
    }
    const Vectors to_light = all(light.place - Point3{}) - p;
    const Double squared = dot(to_light, to_light);
    const Mask well = hn::And(hn::Gt(squared, set(1e-200)), hn::Lt(squared, set(1e200)));
    const Double distance = hn::Sqrt(squared);
    const Divisor by(distance);
    const Double per_unit = told != nullptr ? hn::LoadU(d, told) : by.inverse / by;
    const Mask apart = hn::Ge(distance, set(coincident_distance));
    return {choose(apart, to_light / by, all({})), distance, per_unit, well};
}

/// By mask, in 4 bits each: its lanes. (Highway 1.0.3 has Compress(); GCC 12 copies its table onto
/// the stack at every call.)
constexpr auto lanes_of_mask = [] {
    std::array<std::uint32_t, 256> packed{};
    for (std::uint32_t mask = 0; mask < packed.size(); ++mask) {
        unsigned found = 0;
        for (std::uint32_t lane = 0; lane < 8; ++lane) {
            if ((mask >> lane & 1U) != 0) { packed[mask] |= lane << (4U * found++); }
        }
    }
    return packed;
}();

/// Where to take the lanes of a mask from, so that they come first.
HWY_INLINE auto lanes_of(Mask mask)
{
    const Doubles d;
    const hn::RebindToUnsigned<Doubles> whole;
    std::array<std::uint8_t, 8> bits{};
    hn::StoreMaskBits(d, mask, bits.data());
    const auto packed = hn::Set(whole, lanes_of_mask[bits[0]]);
    const auto shifts = hn::ShiftLeft<2>(hn::Iota(whole, 0));
    return hn::IndicesFromVec(d,
                              hn::And(hn::Shr(packed, shifts), hn::Set(whole, hn::Lanes(d) - 1)));
}
using Indices = decltype(lanes_of(Mask()));

/// The lanes that come first; what follows them is overwritten by the next, or never read.
template <class T>
HWY_INLINE void write(Double x, Indices chosen, RayFields::Field<T>& to, std::size_t i)
{
    write(hn::TableLookupLanes(x, chosen), to, i);
}

bool light(const DeltaGeometry& light, const VertexFields& vertices, std::size_t first,
           std::size_t count, const RayFields::Field<double>* told, RayFields::Field<float>& E,
           ShadowStream* stream)
{
    const Doubles d;
    const std::size_t lanes = hn::Lanes(d);
    const Double zero = hn::Zero(d);
    const Divisor m2(set(light.distant ? 1.0 : light.length_unit_m * light.length_unit_m));
    const UnitBox& box = light.box;
    const ClearanceRule& clear = light.clearance;
    std::size_t rays = 0;
    for (std::size_t i = 0; i < count; i += lanes) {
        const std::size_t v = first + i;
        const Vectors p = read(&vertices.p_x[v], &vertices.p_y[v], &vertices.p_z[v]);
        const Vectors n = read(&vertices.n_x[v], &vertices.n_y[v], &vertices.n_z[v]);
        const Mask there_is = hn::FirstN(d, count - i);
        const auto [wi, distance, per_unit, well] =
            arrive(light, told == nullptr ? nullptr : &(*told)[i], p);
        if (!hn::AllFalse(d, hn::AndNot(well, there_is))) { return false; }
        const Double cos_n = dot(n, wi);
        const Double cos_i = light.two_sided ? hn::Abs(cos_n) : cos_n;
        const Mask faces = hn::And(hn::Gt(cos_i, zero), there_is);
        write(hn::IfThenElse(faces, hn::Mul(cos_i, per_unit / m2), set(-0.0)), E, i);
        if (stream == nullptr || hn::AllFalse(d, faces)) { continue; }
        // shadow_ray()
        const Double spacing = hn::PromoteTo(d, hn::LoadU(Floats(), &vertices.spacing[v]));
        const Double offset =
            hn::Max(set(clear.least),
                    hn::Min(set(clear.most), hn::Mul(set(clear.offset_per_spacing), spacing)));
        const Double from = hn::Mul(set(clear.from_per_spacing), spacing);
        const Vectors origin = p + n * hn::CopySign(offset, cos_n);
        Vectors aim = wi;
        Double reach = set(light.reach);
        if (!light.distant) {
            const Vectors to_light = p + wi * distance - origin;
            const Double length = hn::Sqrt(dot(to_light, to_light));
            const Vectors there = to_light / Divisor(length);
            const Mask ahead = hn::Gt(dot(there, wi), zero);  // false where there is no direction
            aim = choose(ahead, there, wi);
            const Double short_of_light = hn::Sub(length, set(clear.least));
            reach = hn::IfThenElseZero(ahead, hn::Max(zero, hn::Min(reach, short_of_light)));
        }
        // UnitBox::ray()
        const Vectors centre = all(box.centre - Point3{});
        const Vectors org = (origin - centre) * set(box.scale) - aim * set(UnitBox::step_back);
        const Double beyond = hn::Add(
            hn::Add(hn::Add(set(UnitBox::beyond), hn::Abs(org.x)), hn::Abs(org.y)), hn::Abs(org.z));
        const Double tfar =
            hn::Add(hn::Min(hn::Mul(reach, set(box.scale)), beyond), set(2.0 * UnitBox::step_back));
        RayFields& f = stream->fields();
        const Indices chosen = lanes_of(faces);
        write(org.x, chosen, f.org_x, rays);
        write(org.y, chosen, f.org_y, rays);
        write(org.z, chosen, f.org_z, rays);
        write(hn::Mul(from, set(box.scale)), chosen, f.tnear, rays);
        write(aim.x, chosen, f.dir_x, rays);
        write(aim.y, chosen, f.dir_y, rays);
        write(aim.z, chosen, f.dir_z, rays);
        write(tfar, chosen, f.tfar, rays);
        write(origin.x, chosen, f.origin_x, rays);
        write(origin.y, chosen, f.origin_y, rays);
        write(origin.z, chosen, f.origin_z, rays);
        write(aim.x, chosen, f.direction_x, rays);
        write(aim.y, chosen, f.direction_y, rays);
        write(aim.z, chosen, f.direction_z, rays);
        write(from, chosen, f.from, rays);
        write(reach, chosen, f.distance, rays);
        rays += hn::CountTrue(d, faces);
    }
    if (stream != nullptr) { stream->resize(rays); }
    return true;
}

std::uint64_t take_signs(float* E)
{
    const hn::CappedTag<float, 16> d;
    const hn::RebindToSigned<decltype(d)> coded;
    std::uint64_t positive = 0;
    for (std::size_t i = 0; i < 64; i += hn::Lanes(d)) {
        const auto some = hn::LoadU(d, E + i);
        hn::StoreU(hn::Abs(some), d, E + i);
        std::array<std::uint8_t, 8> bits{};  // two, of 16 lanes
        hn::StoreMaskBits(coded, hn::Gt(hn::BitCast(coded, some), hn::Set(coded, -1)), bits.data());
        positive |= static_cast<std::uint64_t>(bits[0] | bits[1] << 8U) << i;
    }
    return positive;
}

}  // namespace
}  // namespace relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relight {

HWY_EXPORT(light);
HWY_EXPORT(take_signs);

bool light_up(const DeltaGeometry& geometry, const VertexFields& fields, std::size_t first,
              std::size_t count, const RayFields::Field<double>* per_unit,
              RayFields::Field<float>& E, ShadowStream* rays)
{
    return HWY_DYNAMIC_DISPATCH(light)(geometry, fields, first, count, per_unit, E, rays);
}

std::uint64_t seen_word(std::span<float, 64> E)
{
    return HWY_DYNAMIC_DISPATCH(take_signs)(E.data());
}

}  // namespace relight
#endif
