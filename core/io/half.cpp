#include "core/io/half.h"

// Compiled once for each instruction set; the best that the machine has is chosen at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/io/half.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, which compiles this file anew.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// As many values as `d` has lanes. Integers and one addition, not the CPU's own conversion: not
/// every CPU has one, and where Highway makes up for it, it truncates.
template <class D>
void convert(D d, const float* in, std::uint16_t* out)
{
    const hn::RebindToFloat<D> floats;
    const auto bits = hn::BitCast(d, hn::LoadU(floats, in));
    const auto magnitude = hn::And(bits, hn::Set(d, 0x7FFFFFFF));
    const auto m = hn::Min(magnitude, hn::Set(d, 0x477FE000));  // 65504
    // 13 bits of the significand go: half of their unit less one, and one more if what stays is
    // odd, carries as rounding does. The exponent's bias shrinks from 127 to 15.
    const auto odd = hn::And(hn::ShiftRight<13>(m), hn::Set(d, 1));
    const auto rounded = hn::Add(hn::Add(m, hn::Set(d, 0xFFF - ((127 - 15) << 23))), odd);
    // Below 2^-14 there is no exponent left: in 0.5 + m the last bit counts 2^-24, as a
    // subnormal's, and the addition has rounded.
    const auto sum = hn::Add(hn::BitCast(floats, m), hn::Set(floats, 0.5F));
    const auto subnormal = hn::Sub(hn::BitCast(d, sum), hn::Set(d, 0x3F000000));  // 0.5
    const auto is_subnormal = hn::Lt(m, hn::Set(d, 0x38800000));                  // 2^-14
    const auto number = hn::IfThenElse(is_subnormal, subnormal, hn::ShiftRight<13>(rounded));
    const auto is_nan = hn::Gt(magnitude, hn::Set(d, 0x7F800000));
    const auto half = hn::IfThenElse(is_nan, hn::Set(d, 0x7E00), number);
    const auto sign = hn::And(hn::ShiftRight<16>(bits), hn::Set(d, 0x8000));
    const hn::Rebind<std::uint16_t, D> halves;
    hn::StoreU(hn::DemoteTo(halves, hn::Or(half, sign)), halves, out);
}

void to_half(const float* in, std::size_t count, std::uint16_t* out)
{
    const hn::ScalableTag<std::int32_t> d;
    const hn::CappedTag<std::int32_t, 1> one;
    const std::size_t lanes = hn::Lanes(d);
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes) { convert(d, in + i, out + i); }
    for (; i < count; ++i) { convert(one, in + i, out + i); }
}

/// Of as many values as `d` has lanes; NaN is beyond nothing.
template <class D>
std::size_t beyond(D d, const float* in)
{
    return hn::CountTrue(d, hn::Ge(hn::Abs(hn::LoadU(d, in)), hn::Set(d, 65520.0F)));
}

std::size_t beyond_half(const float* in, std::size_t count)
{
    const hn::ScalableTag<float> d;
    const hn::CappedTag<float, 1> one;
    const std::size_t lanes = hn::Lanes(d);
    std::size_t i = 0, found = 0;
    for (; i + lanes <= count; i += lanes) { found += beyond(d, in + i); }
    for (; i < count; ++i) { found += beyond(one, in + i); }
    return found;
}

}  // namespace
}  // namespace relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relight {

HWY_EXPORT(to_half);
HWY_EXPORT(beyond_half);

void to_half(std::span<const float> values, std::uint16_t* out)
{
    HWY_DYNAMIC_DISPATCH(to_half)(values.data(), values.size(), out);
}

std::size_t beyond_half(std::span<const float> values)
{
    return HWY_DYNAMIC_DISPATCH(beyond_half)(values.data(), values.size());
}

}  // namespace relight
#endif
