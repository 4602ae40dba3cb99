#include "core/transport/delta_rays.h"

#include "core/light/point_light.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/transport/delta_rays.cpp"
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
static_assert(hn::MaxLanes(Doubles()) <= RayFields::spare);

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
HWY_INLINE Vectors operator/(Vectors a, Double s)
{
    return {hn::Div(a.x, s), hn::Div(a.y, s), hn::Div(a.z, s)};
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
HWY_INLINE Vectors read(const RayFields::Field<double>& x, const RayFields::Field<double>& y,
                        const RayFields::Field<double>& z, std::size_t i)
{
    const Doubles d;
    return {hn::LoadU(d, &x[i]), hn::LoadU(d, &y[i]), hn::LoadU(d, &z[i])};
}

HWY_INLINE void write(Double x, RayFields::Field<double>& to, std::size_t i)
{
    hn::StoreU(x, Doubles(), &to[i]);
}
HWY_INLINE void write(Double x, RayFields::Field<float>& to, std::size_t i)
{
    hn::StoreU(hn::DemoteTo(Floats(), x), Floats(), &to[i]);
}

bool moderate(const DeltaGeometry& light, const DeltaBlock& b)
{
    const Doubles d;
    const std::size_t lanes = hn::Lanes(d);
    const Vectors place = all(light.place - Point3{});
    for (std::size_t i = 0; i < b.count; i += lanes) {
        const Vectors to_light = place - read(b.p_x, b.p_y, b.p_z, i);
        const Vectors n = read(b.n_x, b.n_y, b.n_z, i);
        const Double squared = dot(to_light, to_light);
        const Mask well = hn::And(hn::Gt(squared, set(1e-200)), hn::Lt(squared, set(1e200)));
        const Mask lit = hn::And(hn::Ne(dot(n, n), set(0.0)), hn::FirstN(d, b.count - i));
        if (!hn::AllFalse(d, hn::AndNot(well, lit))) { return false; }
    }
    return true;
}

/// What reaches a vertex of one unit, and whence: Arrival.
struct Arrivals {
    Vectors wi;
    Double distance, per_unit;
};
HWY_INLINE Arrivals arrive(const DeltaGeometry& light, const DeltaBlock& b, std::size_t i,
                           bool inverse_square, Vectors p)
{
    if (light.distant) { return {all(light.wi), set(infinity), set(1.0)}; }
    const Vectors to_light = all(light.place - Point3{}) - p;
    const Double distance = hn::Sqrt(dot(to_light, to_light));
    Double per_unit = hn::Div(hn::Div(set(1.0), distance), distance);
    const Mask apart = hn::Ge(distance, set(coincident_distance));
    if (!inverse_square) { per_unit = hn::LoadU(Doubles(), &b.per_unit[i]); }
    return {choose(apart, to_light / distance, all({})), distance, per_unit};
}

std::size_t light(const DeltaGeometry& light, bool inverse_square, DeltaBlock& b,
                  ShadowStream* stream)
{
    const Doubles d;
    const std::size_t lanes = hn::Lanes(d);
    const Double zero = hn::Zero(d);
    const double m2 = light.distant ? 1.0 : light.length_unit_m * light.length_unit_m;
    const UnitBox& box = light.box;
    const ClearanceRule& clear = light.clearance;
    std::size_t rays = 0;
    for (std::size_t i = 0; i < b.count; i += lanes) {
        const Vectors p = read(b.p_x, b.p_y, b.p_z, i), n = read(b.n_x, b.n_y, b.n_z, i);
        const auto [wi, distance, per_unit] = arrive(light, b, i, inverse_square, p);
        const Double cos_n = dot(n, wi);
        const Double cos_i = light.two_sided ? hn::Abs(cos_n) : cos_n;
        const Mask faces = hn::And(hn::Gt(cos_i, zero), hn::FirstN(d, b.count - i));
        const Double E = hn::IfThenElseZero(faces, hn::Mul(cos_i, hn::Div(per_unit, set(m2))));
        write(E, b.E, i);
        write(hn::IfThenElseZero(faces, set(1.0)), b.faces, i);
        if (stream == nullptr) { continue; }
        // shadow_ray()
        const Double spacing = hn::LoadU(d, &b.spacing[i]);
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
            const Vectors there = to_light / length;
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
        write(org.x, f.org_x, i);
        write(org.y, f.org_y, i);
        write(org.z, f.org_z, i);
        write(hn::Mul(from, set(box.scale)), f.tnear, i);
        write(aim.x, f.dir_x, i);
        write(aim.y, f.dir_y, i);
        write(aim.z, f.dir_z, i);
        write(hn::IfThenElse(faces, tfar, set(-infinity)), f.tfar, i);
        write(origin.x, f.origin_x, i);
        write(origin.y, f.origin_y, i);
        write(origin.z, f.origin_z, i);
        write(aim.x, f.direction_x, i);
        write(aim.y, f.direction_y, i);
        write(aim.z, f.direction_z, i);
        write(from, f.from, i);
        write(reach, f.distance, i);
        rays += hn::CountTrue(d, faces);
    }
    if (stream != nullptr) { stream->resize(b.count); }
    return rays;
}

}  // namespace
}  // namespace relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relight {

HWY_EXPORT(moderate);
HWY_EXPORT(light);

bool is_moderate(const DeltaGeometry& light, const DeltaBlock& block)
{
    return light.distant || HWY_DYNAMIC_DISPATCH(moderate)(light, block);
}

std::size_t light_up(const DeltaGeometry& geometry, bool inverse_square, DeltaBlock& block,
                     ShadowStream* rays)
{
    return HWY_DYNAMIC_DISPATCH(light)(geometry, inverse_square, block, rays);
}

}  // namespace relight
#endif
