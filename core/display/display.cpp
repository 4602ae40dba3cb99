#include "core/display/display.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/display/codes.h"

namespace relight {
namespace {

/// Light is not negative, and the rational curves square it: NaN and negatives are dark, infinity
/// is merely very bright.
double light_of(double x)
{
    constexpr double brightest = 1e30;
    return x > 0.0 ? std::min(x, brightest) : 0.0;
}

template <class Curve>
Rgb each_band(Rgb x, Curve curve)
{
    return {curve(x.r), curve(x.g), curve(x.b)};
}

double clamp01(double x)
{
    return x > 0.0 ? std::min(x, 1.0) : 0.0;
}  // NaN is dark

double reinhard(double x)
{
    return x / (1.0 + x);
}

/// Luminance L becomes L (1 + L/white^2) / (1 + L), colour kept.   Reinhard et al. 2002, eq. 4
Rgb reinhard_extended(Rgb x, double white)
{
    const double L = luminance(x);
    return x * ((1.0 + L / (white * white)) / (1.0 + L));
}

/// Narkowicz 2016, without the 0.6 by which he matches the ACES reference's exposure.
double aces_narkowicz(double x)
{
    return clamp01(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14));
}

/// Hill's fit of the ACES RRT and sRGB ODT (encoding left out): into the working space, a rational
/// curve a band, and back. Rows sum to 1 up to the fit's five digits.
Rgb aces_hill(Rgb x)
{
    const auto curve = [](double v) {
        return (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081);
    };
    const Rgb v = each_band({0.59719 * x.r + 0.35458 * x.g + 0.04823 * x.b,
                             0.07600 * x.r + 0.90834 * x.g + 0.01566 * x.b,
                             0.02840 * x.r + 0.13383 * x.g + 0.83777 * x.b},
                            curve);
    return each_band({1.60475 * v.r - 0.53108 * v.g - 0.07367 * v.b,
                      -0.10208 * v.r + 1.10813 * v.g - 0.00605 * v.b,
                      -0.00327 * v.r - 0.07276 * v.g + 1.07602 * v.b},
                     clamp01);
}

/// Khronos PBR Neutral: takes away the 4 % Fresnel haze, leaves base colours as they are up to Ks,
/// compresses the rest toward 1 and, the brighter it was, toward white.
Rgb pbr_neutral(Rgb x)
{
    constexpr double F90 = 0.04, Ks = 0.8 - F90, Kd = 0.15;
    const double least = std::min({x.r, x.g, x.b});
    const double haze = least < 2.0 * F90 ? least - least * least / (4.0 * F90) : F90;
    const Rgb c = x - Rgb::grey(haze);
    const double peak = std::max({c.r, c.g, c.b});
    if (peak < Ks) { return c; }
    const double room = 1.0 - Ks;
    const double new_peak = 1.0 - room * room / (peak + room - Ks);
    const double keep = 1.0 / (Kd * (peak - new_peak) + 1.0);
    return c * (new_peak / peak * keep) + Rgb::grey(new_peak * (1.0 - keep));
}

}  // namespace

double srgb_oetf(double linear)
{
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

double srgb_eotf(double encoded)
{
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

Rgb srgb_eotf(Rgb8 encoded)
{
    static const auto linear_of = [] {
        std::array<double, 256> table{};
        for (std::size_t code = 0; code < table.size(); ++code) {
            table[code] = srgb_eotf(static_cast<double>(code) / 255.0);
        }
        return table;
    }();
    return {linear_of[encoded[0]], linear_of[encoded[1]], linear_of[encoded[2]]};
}

unsigned char to_code(double encoded)
{
    return static_cast<unsigned char>(std::lround(255.0 * clamp01(encoded)));
}

double exposure_scale(double ev)
{
    return std::exp2(ev);
}

double ev100(double aperture_n, double shutter_s, double iso)
{
    return std::log2(aperture_n * aperture_n / shutter_s * 100.0 / iso);
}

double ev100_scale(double ev)
{
    return std::exp2(-ev) / 1.2;
}

Rgb tone_map(Rgb x, ToneMap map, double white)
{
    if (map == ToneMap::None) { return x; }
    const Rgb light = each_band(x, light_of);
    switch (map) {
        case ToneMap::Reinhard:
            return each_band(light, reinhard);
        case ToneMap::ReinhardExtended:
            return reinhard_extended(light, white);
        case ToneMap::AcesNarkowicz:
            return each_band(light, aces_narkowicz);
        case ToneMap::AcesHill:
            return aces_hill(light);
        case ToneMap::PbrNeutral:
            return pbr_neutral(light);
        case ToneMap::None:
            break;
    }
    return light;
}

double auto_exposure_ev(std::span<const Rgbf> radiance)
{
    constexpr double share = 0.95, target = 0.8;
    std::vector<double> lit;
    for (const Rgbf& pixel : radiance) {
        const double L = luminance(to_double(pixel));
        if (L > 0.0 && std::isfinite(L)) { lit.push_back(L); }
    }
    if (lit.empty()) { return 0.0; }
    const double rank = std::ceil(share * static_cast<double>(lit.size())) - 1.0;
    const auto nth = lit.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(lit.begin(), nth, lit.end());
    return std::log2(target / *nth);
}

unsigned char code_of(double linear)
{
    return to_code(srgb_oetf(clamp01(linear)));
}

Rgb8 to_srgb8(Rgb radiance, const Display& display)
{
    const Rgb shown =
        tone_map(radiance * exposure_scale(display.exposure_ev), display.tone_map, display.white);
    return {code_of(shown.r), code_of(shown.g), code_of(shown.b)};
}

UnsetVector<Rgb8> to_srgb8(std::span<const Rgbf> radiance, const Display& display, unsigned threads,
                           Progress& progress)
{
    static const CodeTable code;
    constexpr std::size_t block = 16384;
    const double scale = exposure_scale(display.exposure_ev);
    UnsetVector<Rgb8> codes(radiance.size());
    if (display.tone_map == ToneMap::None &&
        FloatCodeTable::serves(scale)) {  // each band for itself
        const FloatCodeTable table(code, scale);
        parallel_for(codes.size(), block, threads, progress,
                     [&](std::size_t begin, std::size_t end) {
                         look_up(table.codes(), radiance[begin].data(), 3 * (end - begin),
                                 codes[begin].data());
                     });
        return codes;
    }
    parallel_for(codes.size(), block, threads, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const Rgb shown =
                tone_map(to_double(radiance[i]) * scale, display.tone_map, display.white);
            codes[i] = {code(shown.r), code(shown.g), code(shown.b)};
        }
    });
    return codes;
}

}  // namespace relight
