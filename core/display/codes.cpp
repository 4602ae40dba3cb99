#include "core/display/codes.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "core/display/codes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relight::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

HWY_INLINE auto code_of(const Codes& codes, hn::Vec<hn::ScalableTag<float>> x)
{
    const hn::ScalableTag<float> floats;
    const hn::ScalableTag<std::int32_t> ints;
    const auto lit = hn::IfThenElseZero(x > hn::Zero(floats), x);
    const auto darkest = hn::Set(ints, codes.darkest);
    const auto within =
        hn::Min(hn::Max(hn::BitCast(ints, lit), darkest), hn::Set(ints, codes.brightest));
    const auto past = within - darkest;
    const auto entry = hn::GatherIndex(ints, codes.entries, hn::ShiftRight<16>(past));
    const auto sum = entry + hn::And(past, hn::Set(ints, 0xFFFF));
    return hn::DemoteTo(hn::Rebind<std::uint8_t, hn::ScalableTag<float>>(),
                        hn::ShiftRight<16>(sum));
}

void look_up_all(const Codes& codes, const float* linear, std::size_t count, unsigned char* code)
{
    const hn::ScalableTag<float> floats;
    const hn::Rebind<std::uint8_t, hn::ScalableTag<float>> bytes;
    const std::size_t lanes = hn::Lanes(floats);
    std::size_t i = 0;
    for (; i + lanes <= count; i += lanes) {
        hn::StoreU(code_of(codes, hn::LoadU(floats, linear + i)), bytes, code + i);
    }
    for (; i < count; ++i) {  // each lane alike
        code[i] = hn::GetLane(code_of(codes, hn::Set(floats, linear[i])));
    }
}

}  // namespace
}  // namespace relight::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relight {

HWY_EXPORT(look_up_all);

void look_up(const Codes& codes, const float* linear, std::size_t count, unsigned char* code)
{
    HWY_DYNAMIC_DISPATCH(look_up_all)(codes, linear, count, code);
}

}  // namespace relight
#endif
