#include "core/texture/texture.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

namespace relight {
namespace {

/// IEC 61966-2-1: linear light of each 8-bit code.
std::array<double, 256> decoded_srgb()
{
    std::array<double, 256> linear{};
    for (std::size_t code = 0; code < linear.size(); ++code) {
        const double c = static_cast<double>(code) / 255.0;
        linear[code] = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
    }
    return linear;
}

/// Along one axis: the two texels beside a place, and how far it is from the first to the second.
struct Taps {
    std::size_t first{}, second{};
    double t{};
};

/// `x` counts pictures. It is folded into one before it counts texels: no integer overflows,
/// however large it is.
Taps taps(double x, Wrap wrap, int size, bool nearest)
{
    double inside = x;
    if (wrap == Wrap::Repeat) { inside = x - std::floor(x); }
    if (wrap == Wrap::MirroredRepeat) {
        inside = 1.0 - std::abs(x - 2.0 * std::floor(0.5 * x) - 1.0);
    }
    // Also where rounding has brought 1 - 1e-20 to 1.
    const double texels = std::fmin(std::fmax(inside, 0.0), 1.0) * size;
    if (nearest) {
        const int texel = std::min(static_cast<int>(texels), size - 1);
        return {static_cast<std::size_t>(texel), static_cast<std::size_t>(texel), 0.0};
    }
    const double before = std::floor(texels - 0.5);  // -1 .. size - 1: centres are at halves
    const int first = static_cast<int>(before);
    const int second = first + 1;
    // A mirror at the edge shows the edge's own texel again, as clamping does.
    const bool around = wrap == Wrap::Repeat;
    const int under = around ? size - 1 : 0;
    const int over = around ? 0 : size - 1;
    return {static_cast<std::size_t>(first < 0 ? under : first),
            static_cast<std::size_t>(second < size ? second : over), texels - 0.5 - before};
}

TextureSample mix(const TextureSample& a, const TextureSample& b, double t)
{
    return {a.rgb + (b.rgb - a.rgb) * t, a.alpha + (b.alpha - a.alpha) * t};
}

/// Bilinear, of texels decoded by `decode`.
template <class Decode>
TextureSample sample(const Texture& texture, const TextureMap& map, Uv uv, const Decode& decode)
{
    assert(texture.width > 0 && texture.height > 0);
    const auto& m = map.transform;
    const auto along = [&](std::size_t row) {  // in double: products of floats are finite
        return double{m[row]} * uv[0] + double{m[row + 1]} * uv[1] + m[row + 2];
    };
    const Taps u = taps(along(0), map.wrap_u, texture.width, map.nearest);
    const Taps v = taps(along(3), map.wrap_v, texture.height, map.nearest);
    const auto row = [&](std::size_t y) {
        const auto* const texels = &texture.texels[y * static_cast<std::size_t>(texture.width)];
        return mix(decode(texels[u.first]), decode(texels[u.second]), u.t);
    };
    return mix(row(v.first), row(v.second), v.t);
}

}  // namespace

TextureSample sample_linear(const Texture& texture, const TextureMap& map, Uv uv)
{
    return sample(texture, map, uv, [](const std::array<std::uint8_t, 4>& texel) {
        return TextureSample{Rgb{texel[0] / 255.0, texel[1] / 255.0, texel[2] / 255.0},
                             texel[3] / 255.0};
    });
}

TextureSample sample_srgb(const Texture& texture, const TextureMap& map, Uv uv)
{
    static const std::array<double, 256> linear = decoded_srgb();
    return sample(texture, map, uv, [](const std::array<std::uint8_t, 4>& texel) {
        return TextureSample{Rgb{linear[texel[0]], linear[texel[1]], linear[texel[2]]},
                             texel[3] / 255.0};
    });
}

}  // namespace relight
