#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/rgb.h"
#include "core/base/unset.h"

namespace relight {

enum class ToneMap { None, Reinhard, ReinhardExtended, AcesNarkowicz, AcesHill, PbrNeutral };

struct Display {
    double exposure_ev = 0.0;    ///< scale 2^EV before the tone map
    bool auto_exposure = false;  ///< choose exposure_ev from the picture
    ToneMap tone_map = ToneMap::None;
    double white = 4.0;  ///< ReinhardExtended: luminance that maps to 1
};

/// IEC 61966-2-1: linear [0,1] -> encoded [0,1], and back.
double srgb_oetf(double linear);
double srgb_eotf(double encoded);
Rgb srgb_eotf(Rgb8 encoded);            ///< of 8-bit codes
unsigned char to_code(double encoded);  ///< round(255 y), clamped

/// 2^EV.
double exposure_scale(double ev);
/// EV100 = log2(N^2/t 100/S) of a camera's settings; the scale for nit scenes is 1/(1.2 2^EV100).
double ev100(double aperture_n, double shutter_s, double iso);
double ev100_scale(double ev);

/// The tone map alone, on linear radiance after exposure; output linear, unclamped for None.
Rgb tone_map(Rgb x, ToneMap map, double white);

/// Exposure that puts the 95th percentile of the positive luminances at 0.8: EV [stops]; 0 if all
/// is dark.
double auto_exposure_ev(std::span<const Rgbf> radiance);

/// exposure -> tone map -> clamp -> sRGB -> 8 bits: the only place where it happens.
/// Display::auto_exposure must have been resolved into exposure_ev.
Rgb8 to_srgb8(Rgb radiance, const Display& display);
UnsetVector<Rgb8> to_srgb8(std::span<const Rgbf> radiance, const Display& display, unsigned threads,
                           Progress& progress);

}  // namespace relight
