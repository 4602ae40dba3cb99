#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace relight {

/// The code of a linear band, by the formula: sRGB, clamped.
unsigned char code_of(double linear);

/// The same codes without a power: code c begins at the least double that the formula gives c.
/// Which codes are near, the first bits of the number tell: its exponent and 7 bits behind the
/// point. Codes begin farther apart than 2^-7 of their value (least, 0.9 %, at white), so one
/// comparison is left. All in integers, as which doubles above zero are ordered too.
class CodeTable {
  public:
    CodeTable()
    {
        std::int64_t begin = darkest;
        for (std::size_t code = 1; code < 256; ++code) {
            std::int64_t end = brightest;
            while (begin < end) {
                const std::int64_t middle = begin + (end - begin) / 2;
                const bool there = code_of(std::bit_cast<double>(middle)) >= code;
                (there ? end : begin) = there ? middle : middle + 1;
            }
            begins_[code] = begin;
        }
        begins_[256] = std::numeric_limits<std::int64_t>::max();
        for (std::size_t step = 0; step < first_code_.size(); ++step) {
            const auto bits = darkest + (static_cast<std::int64_t>(step) << dropped);
            first_code_[step] = code_of(std::bit_cast<double>(bits));
        }
    }

    unsigned char operator()(double linear) const
    {
        const auto bits = std::bit_cast<std::int64_t>(linear > 0.0 ? linear : 0.0);  // NaN is dark
        const std::int64_t step = (std::clamp(bits, darkest, brightest) - darkest) >> dropped;
        const unsigned code = first_code_[static_cast<std::size_t>(step)];
        return static_cast<unsigned char>(code + (bits >= begins_[code + 1] ? 1U : 0U));
    }

  private:
    static constexpr auto darkest = std::bit_cast<std::int64_t>(0x1p-13);  // code 1: from 1.5e-4
    static constexpr auto brightest = std::bit_cast<std::int64_t>(1.0);
    static constexpr unsigned dropped = 52 - 7;

    std::array<std::int64_t, 257> begins_{};
    std::array<unsigned char, 13 * 128 + 1> first_code_{};  // of each step from darkest on
};

/// sRGB codes of floats by one look-up. A float above zero is a number of bits, in the same order:
/// those from `darkest` on are cut into steps of 2^16, in each of which at most one code begins.
/// To a step's entry the last 16 bits are added: the sum's bits from 16 on are the code, for it
/// carries where the next code begins.
struct Codes {
    std::int32_t darkest = 0, brightest = 0;  ///< below is code 0, from there on 255
    const std::int32_t* entries = nullptr;    ///< of the steps from darkest to brightest
};

/// Of `count` floats; NaN is dark.
void look_up(const Codes& codes, const float* linear, std::size_t count, unsigned char* code);

/// The same codes of floats under one exposure. Floats above zero are ordered as their bits are.
class FloatCodeTable {
  public:
    FloatCodeTable(const CodeTable& code, double scale)
    {
        const auto code_at = [&](std::int32_t bits) {
            return code(static_cast<double>(std::bit_cast<float>(bits)) * scale);
        };
        const auto first_of = [&](int wanted, std::int32_t begin, std::int32_t end) {
            while (begin < end) {
                const std::int32_t middle = begin + (end - begin) / 2;
                const bool there = code_at(middle) >= wanted;
                (there ? end : begin) = there ? middle : middle + 1;
            }
            return begin;
        };
        constexpr std::int32_t step = 1 << 16;
        codes_.darkest = first_of(1, 0, infinite) / step * step;
        codes_.brightest = first_of(255, codes_.darkest, infinite);
        for (std::int32_t begin = codes_.darkest; begin <= codes_.brightest; begin += step) {
            const int code_there = code_at(begin);
            const std::int32_t next = first_of(code_there + 1, begin, begin + step);
            entries_.push_back(code_there * step + (begin + step - next));
        }
        codes_.entries = entries_.data();
    }
    FloatCodeTable(const FloatCodeTable&) = delete;
    FloatCodeTable& operator=(const FloatCodeTable&) = delete;

    /// Whether floats have all the codes: neither denormals nor infinity begin one.
    static bool serves(double scale) { return scale > 0x1p-100 && scale < 0x1p100; }

    const Codes& codes() const { return codes_; }

  private:
    static constexpr auto infinite =
        std::bit_cast<std::int32_t>(std::numeric_limits<float>::infinity());

    std::vector<std::int32_t> entries_;
    Codes codes_;
};

}  // namespace relight
