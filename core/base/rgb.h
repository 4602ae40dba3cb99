#pragma once

#include <array>

namespace relight {

/// Three independent bands, linear Rec.709 unless a name says sRGB.
struct Rgb {
    double r{}, g{}, b{};

    static constexpr Rgb grey(double v) { return {v, v, v}; }
    constexpr Rgb operator+(Rgb o) const { return {r + o.r, g + o.g, b + o.b}; }
    constexpr Rgb operator-(Rgb o) const { return {r - o.r, g - o.g, b - o.b}; }
    constexpr Rgb operator*(Rgb o) const { return {r * o.r, g * o.g, b * o.b}; }
    constexpr Rgb operator*(double s) const { return {r * s, g * s, b * s}; }
    constexpr Rgb operator/(double s) const { return {r / s, g / s, b / s}; }
    constexpr Rgb& operator+=(Rgb o) { return *this = *this + o; }
    constexpr bool operator==(const Rgb&) const = default;
};
constexpr Rgb operator*(double s, Rgb c)
{
    return c * s;
}

/// Y = .2126 R + .7152 G + .0722 B of linear Rec.709.
constexpr double luminance(Rgb c)
{
    return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b;
}

/// What arrays store: one attribute, float, interleaved.
using Rgbf = std::array<float, 3>;
using Rgb8 = std::array<unsigned char, 3>;  ///< display-referred, sRGB-encoded

constexpr Rgbf to_float(Rgb c)
{
    return {static_cast<float>(c.r), static_cast<float>(c.g), static_cast<float>(c.b)};
}
constexpr Rgb to_double(Rgbf c)
{
    return {static_cast<double>(c[0]), static_cast<double>(c[1]), static_cast<double>(c[2])};
}

}  // namespace relight
