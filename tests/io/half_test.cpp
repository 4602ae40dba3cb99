#include "core/io/half.h"

#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace relight {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr std::uint16_t largest = 0x7BFF;  // 65504

/// What binary16 means: sign, 5 bits of exponent, 10 of significand.   IEEE 754-2008, 3.4
double value_of(std::uint16_t half)
{
    const int exponent = (half >> 10) & 31, significand = half & 1023;
    return exponent == 0 ? std::ldexp(significand, -24)
                         : std::ldexp(1024 + significand, exponent - 25);
}

/// The nearest of all, by looking for it; of two, the even one.
std::uint16_t nearest(float x)
{
    static const std::vector<double> all = [] {
        std::vector<double> values;
        for (std::uint16_t half = 0; half <= largest; ++half) { values.push_back(value_of(half)); }
        return values;
    }();
    const std::uint16_t sign = std::signbit(x) ? 0x8000 : 0;
    if (std::isnan(x)) { return sign | 0x7E00; }
    const double magnitude = std::abs(static_cast<double>(x));
    const auto above = std::lower_bound(all.begin(), all.end(), magnitude);
    auto half = static_cast<std::uint16_t>(above - all.begin());
    if (above == all.end()) { return sign | largest; }
    if (half > 0) {
        const double up = *above - magnitude, down = magnitude - all[half - 1U];
        if (down < up || (down == up && half % 2 == 1)) { --half; }
    }
    return sign | half;
}

/// Every binary16, every middle between two, and the floats next to each; and any others.
std::vector<float> telling_floats()
{
    std::vector<float> values;
    const auto add = [&](double value) {
        const auto x = static_cast<float>(value);
        EXPECT_EQ(static_cast<double>(x), value);
        for (const float y : {std::nextafter(x, -infinity), x, std::nextafter(x, infinity)}) {
            values.insert(values.end(), {y, -y});
        }
    };
    for (std::uint16_t half = 0; half < largest; ++half) {
        add(value_of(half));
        add((value_of(half) + value_of(half + 1U)) / 2);
    }
    for (const double x : {65504.0, 65505.0, 65519.0, 65520.0, 65536.0, 1e9}) { add(x); }
    std::mt19937 random(16);
    for (int i = 0; i < 300'000; ++i) {  // NaN of any payload, infinity and subnormals among them
        values.push_back(std::bit_cast<float>(static_cast<std::uint32_t>(random())));
    }
    values.insert(values.end(), {infinity, -infinity, 1e-45F, -0.0F, 0.0F});
    values.push_back(std::numeric_limits<float>::max());
    return values;
}

std::vector<std::uint16_t> halves_of(std::span<const float> values)
{
    std::vector<std::uint16_t> halves(values.size(), 0xDEAD);
    to_half(values, halves.data());
    return halves;
}

TEST(Half, IsTheNearestOnEveryInstructionSet)
{
    const std::vector<float> values = telling_floats();
    std::vector<std::uint16_t> expected;
    expected.reserve(values.size());
    std::size_t beyond = 0;
    for (const float x : values) {
        expected.push_back(nearest(x));
        if (std::abs(x) >= 65520.0F) { ++beyond; }
    }
    int sets = 0;
    for (std::int64_t left = hwy::SupportedTargets() & HWY_TARGETS; left != 0; left &= left - 1) {
        const std::int64_t target = left & -left;
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(target);
        EXPECT_EQ(beyond_half(values), beyond) << hwy::TargetName(target);
        const std::vector<std::uint16_t> halves = halves_of(values);
        for (std::size_t i = 0; i < values.size(); ++i) {
            ASSERT_EQ(halves[i], expected[i]) << values[i] << " with " << hwy::TargetName(target);
        }
        ++sets;
    }
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    EXPECT_GE(sets, 1);
    EXPECT_EQ(halves_of(values), expected);
}

TEST(Half, OfAnyNumberOfValuesStaysInItsPlace)
{
    std::vector<float> values(70);
    for (std::size_t i = 0; i < values.size(); ++i) { values[i] = static_cast<float>(i); }
    for (std::size_t count = 0; count < values.size(); ++count) {
        std::vector<std::uint16_t> halves(count + 1, 0xDEAD);
        to_half(std::span(values).first(count), halves.data());
        for (std::size_t i = 0; i < count; ++i) { EXPECT_EQ(halves[i], nearest(values[i])); }
        EXPECT_EQ(halves[count], 0xDEAD);
        const std::vector<float> large(count, -1e9F);
        EXPECT_EQ(beyond_half(large), count);
    }
}

}  // namespace
}  // namespace relight
