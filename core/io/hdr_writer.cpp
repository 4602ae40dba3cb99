#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "core/io/text_out.h"
#include "core/io/writers.h"

namespace relight {
namespace {

using Rgbe = std::array<unsigned char, 4>;

/// The nearest texel: mantissa / 256 * 2^(e - 128), both from 0 to 255, e = 0 for black. Off by
/// 1/256 of the largest band at most, half a step of a mantissa that is 128 or more. What is too
/// dark becomes black, what is too bright the brightest; below 0 is 0. (Smaller mantissas would
/// reach further down, but three of 1 mark a run in the old packing.)
Rgbe rgbe(Rgbf color)
{
    constexpr int bias = 128;
    constexpr float brightest = 255.0F * 0x1p119F;
    for (float& band : color) { band = band > 0.0F ? std::min(band, brightest) : 0.0F; }
    const float largest = std::max({color[0], color[1], color[2]});
    int exponent = 0;
    std::frexp(largest, &exponent);  // largest = m 2^exponent, m in [1/2, 1)
    if (std::lround(std::ldexp(largest, 8 - exponent)) > 255) { ++exponent; }  // m rounds up to 1
    if (largest == 0.0F || exponent + bias < 1) { return {}; }
    Rgbe texel{};
    for (std::size_t band = 0; band < 3; ++band) {
        const float mantissa = std::ldexp(color[band], 8 - exponent);
        texel[band] = static_cast<unsigned char>(std::lround(mantissa));
    }
    texel[3] = static_cast<unsigned char>(exponent + bias);
    return texel;
}

/// One channel of a scanline: runs (128 + n, value) and literals (n, values), n up to 127 and 128.
void append_packed(std::string& out, const std::string& line)
{
    constexpr std::size_t longest_run = 127, longest_literal = 128, worth_a_run = 4;
    const auto run_at = [&](std::size_t x) {
        std::size_t n = 1;
        while (n < longest_run && x + n < line.size() && line[x + n] == line[x]) { ++n; }
        return n;
    };
    for (std::size_t x = 0; x < line.size();) {
        std::size_t literal = 0, run = run_at(x);
        while (run < worth_a_run && x + literal < line.size() && literal < longest_literal) {
            literal += std::min(run, longest_literal - literal);
            run = x + literal < line.size() ? run_at(x + literal) : 0;
        }
        if (literal > 0) {
            out += static_cast<char>(literal);
            out.append(line, x, literal);
            x += literal;
            continue;
        }
        out += static_cast<char>(128 + run);
        out += line[x];
        x += run;
    }
}

}  // namespace

std::string write_hdr(int width, int height, std::span<const Rgbf> pixels,
                      std::span<const std::string> comments)
{
    const auto columns = static_cast<std::size_t>(width);
    assert(pixels.size() == columns * static_cast<std::size_t>(height));
    std::string out = "#?RADIANCE\n";
    for (const std::string& comment : comments) { out += "# " + one_line(comment) + "\n"; }
    out += "FORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(height) + " +X " +
           std::to_string(width) + "\n";
    const bool packed = columns >= 8 && columns <= 0x7FFF;
    std::array<std::string, 4> channels;
    for (std::size_t row = 0; row < pixels.size(); row += columns) {
        for (std::string& channel : channels) { channel.clear(); }
        for (const Rgbf& color : pixels.subspan(row, columns)) {
            const Rgbe texel = rgbe(color);
            for (std::size_t k = 0; k < texel.size(); ++k) {
                (packed ? channels[k] : out) += static_cast<char>(texel[k]);
            }
        }
        if (!packed) { continue; }
        out.append({2, 2, static_cast<char>(columns >> 8U), static_cast<char>(columns & 0xFFU)});
        for (const std::string& channel : channels) { append_packed(out, channel); }
    }
    return out;
}

}  // namespace relight
