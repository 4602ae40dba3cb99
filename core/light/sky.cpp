#include "core/light/sky.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "core/light/temperature.h"
#include "core/light/xyz.h"

namespace relight {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double degree = pi / 180.0;
constexpr double sun_half_angle = 0.2665 * degree;  // at the mean distance

/// Relative luminance (or chromaticity) over a clear sky; theta from the zenith, gamma from the
/// sun.   Perez, Seals & Michalsky 1993
struct Perez {
    double A, B, C, D, E;

    double F(double cos_theta, double gamma) const
    {
        const double cos_gamma = std::cos(gamma);
        return (1.0 + A * std::exp(B / cos_theta)) *
               (1.0 + C * std::exp(D * gamma) + E * cos_gamma * cos_gamma);
    }
};

/// A quantity of the sky: its value at the zenith and its distribution around.
struct Channel {
    double zenith;
    Perez perez;

    double at(double cos_theta, double gamma, double theta_s) const
    {
        return zenith * perez.F(cos_theta, gamma) / perez.F(1.0, theta_s);
    }
};

/// Preetham, Shirley & Smits 1999, appendix A.2: fits over turbidity T and the sun's zenith angle.
struct Preetham {
    double theta_s;
    Channel Y;     ///< luminance [cd/m^2]
    Channel x, y;  ///< chromaticity

    Preetham(double T, double sun_zenith_angle)
        : theta_s(sun_zenith_angle),
          Y{zenith_luminance(T),
            {0.1787 * T - 1.4630, -0.3554 * T + 0.4275, -0.0227 * T + 5.3251, 0.1206 * T - 2.5771,
             -0.0670 * T + 0.3703}},
          x{cubic(T * (T * 0.00166 - 0.02903) + 0.11693, T * (T * -0.00375 + 0.06377) - 0.21196,
                  T * (T * 0.00209 - 0.03202) + 0.06052, T * 0.00394 + 0.25886),
            {-0.0193 * T - 0.2592, -0.0665 * T + 0.0008, -0.0004 * T + 0.2125, -0.0641 * T - 0.8989,
             -0.0033 * T + 0.0452}},
          y{cubic(T * (T * 0.00275 - 0.04214) + 0.15346, T * (T * -0.00610 + 0.08970) - 0.26756,
                  T * (T * 0.00317 - 0.04153) + 0.06670, T * 0.00516 + 0.26688),
            {-0.0167 * T - 0.2608, -0.0950 * T + 0.0092, -0.0079 * T + 0.2102, -0.0441 * T - 1.6537,
             -0.0109 * T + 0.0529}}
    {
    }

    double zenith_luminance(double T) const
    {
        const double chi = (4.0 / 9.0 - T / 120.0) * (pi - 2.0 * theta_s);
        return 1000.0 * ((4.0453 * T - 4.9710) * std::tan(chi) - 0.2155 * T + 2.4192);
    }
    double cubic(double c3, double c2, double c1, double c0) const
    {
        return ((c3 * theta_s + c2) * theta_s + c1) * theta_s + c0;
    }

    /// [cd/m^2] linear Rec.709.
    Rgb radiance(double cos_theta, double gamma) const
    {
        const double L = Y.at(cos_theta, gamma, theta_s);
        const double cx = x.at(cos_theta, gamma, theta_s), cy = y.at(cos_theta, gamma, theta_s);
        return rec709({L * cx / cy, L, L * (1.0 - cx - cy) / cy});
    }
};

/// Its value at the middle of every texel above the horizon. On this grid E of a horizontal place
/// is within 0.5 % of the model's.   Test: Sky.TheDomesTableKeepsItsIlluminance
Image dome(Dir3 toward_sun, double turbidity, double scale)
{
    Image image{512, 256, {}, {}};
    image.pixels.resize(image.at(0, image.height));
    const Preetham sky(turbidity, std::acos(std::clamp(toward_sun.y(), 0.0, 1.0)));
    for (int row = 0; row < image.height / 2; ++row) {
        const double theta = pi * (row + 0.5) / image.height;
        for (int column = 0; column < image.width; ++column) {
            const double phi = pi * (2.0 * (column + 0.5) / image.width - 1.0);
            const Vec3 w{std::sin(theta) * std::cos(phi), std::cos(theta),
                         std::sin(theta) * std::sin(phi)};
            const double gamma = std::acos(std::clamp(dot(w, toward_sun), -1.0, 1.0));
            image.pixels[image.at(column, row)] = to_float(sky.radiance(w.y, gamma) * scale);
        }
    }
    return image;
}

/// What a sun below the horizon leaves of the sky. Illuminance falls by a factor of 10 for every
/// 2.8 degrees and is gone at 18: 1/200 at 6 degrees and 1.7e-5 at 12, where the Glossary of
/// Meteorology (AMS, "civil twilight" and on) has 410-585 lx, 2-3.5 lx and 0.008 lx.
double twilight(double altitude_deg)
{
    if (altitude_deg >= 0.0) { return 1.0; }
    return std::pow(10.0, altitude_deg / 2.8) * std::max(0.0, 1.0 + altitude_deg / 18.0);
}

/// Share of the sun's disc above the horizon (refraction not counted).
double risen(double altitude)
{
    const double x = std::clamp(altitude / sun_half_angle, -1.0, 1.0);
    return std::clamp((std::acos(-x) + x * std::sqrt(1.0 - x * x)) / pi, 0.0, 1.0);
}

/// E of the direct sun on what faces it [lx]: the sun above the air, dimmed by Beer's law in three
/// narrow bands, the dominant wavelengths of Rec.709's primaries. Optical depths: Preetham et al.
/// 1999, appendix A.1 (Iqbal 1983); relative air mass: Kasten & Young 1989.
Rgb direct_sun(double altitude, double turbidity)
{
    constexpr double illuminance = 133.3e3;   // [lx] above the air. Darula, Kittler & Gueymard 2005
    constexpr double temperature_k = 5772.0;  // effective. IAU 2015, resolution B3
    const double h = std::max(0.0, altitude / degree);
    const double air_mass = 1.0 / (std::sin(h * degree) + 0.50572 * std::pow(h + 6.07995, -1.6364));
    const double beta = 0.04608365822050 * turbidity - 0.04586025928522;
    const auto transmitted = [&](double um, double ozone_per_cm) {
        constexpr double ozone_cm = 0.35;  // of the gas at normal temperature and pressure
        const double rayleigh = 0.008735 * std::pow(um, -4.08);
        const double aerosol = beta * std::pow(um, -1.3);  // Angstrom
        return std::exp(-air_mass * (rayleigh + aerosol + ozone_per_cm * ozone_cm));
    };
    return blackbody(temperature_k) * (illuminance * risen(altitude)) *
           Rgb{transmitted(0.611, 0.120), transmitted(0.549, 0.085), transmitted(0.464, 0.008)};
}

}  // namespace

SkyLight make_sky(Dir3 toward_sun, double turbidity)
{
    assert(turbidity >= least_turbidity && turbidity <= largest_turbidity);
    const double altitude = std::atan2(toward_sun.y(), std::hypot(toward_sun.x(), toward_sun.z()));
    const Dir3 above =
        altitude < 0.0 ? normalize({toward_sun.x(), 0.0, toward_sun.z()}) : toward_sun;
    SkyLight light;
    light.dome =
        std::make_shared<const EnvironmentMap>(dome(above, turbidity, twilight(altitude / degree)));
    light.sun = {-toward_sun, sun_half_angle};
    light.sun_E_perp = direct_sun(altitude, turbidity);
    light.turbidity = turbidity;
    return light;
}

SkyView::SkyView(const SkyLight& light) : sun_(light.sun), E_perp_(light.sun_E_perp)
{
    const bool sun = luminance(light.sun_E_perp) > 0.0;
    if (light.dome && light.dome->luminance_integral() > 0.0) { dome_ = light.dome.get(); }
    sun_share_ = sun ? (dome_ != nullptr ? 0.5 : 1.0) : 0.0;
}

LightSample SkyView::sample(Sample2 s, double pick) const
{
    if (pick < sun_share_) {
        const LightSample disc = sun_.sample(s);
        return mixed(disc, dome_ != nullptr ? dome_->look(disc.wi) : EnvironmentMap::Seen{});
    }
    if (dome_ == nullptr) { return {}; }
    const EnvironmentMap::Seen dome = dome_->sample(s);
    LightSample disc = sun_.look(unit_already(dome.w));
    disc.wi = unit_already(dome.w);
    return mixed(disc, dome);
}

LightSample SkyView::look(Dir3 wi) const
{
    if (!wi || (sun_share_ == 0.0 && dome_ == nullptr)) { return {}; }
    LightSample disc = sun_.look(wi);
    disc.wi = wi;
    return mixed(disc, dome_ != nullptr ? dome_->look(wi) : EnvironmentMap::Seen{});
}

LightSample SkyView::mixed(const LightSample& disc, const EnvironmentMap::Seen& dome) const
{
    LightSample seen;
    seen.wi = disc.wi;
    if (sun_share_ > 0.0) {
        seen.L = E_perp_ * disc.L;
        seen.pdf = sun_share_ * disc.pdf;
    }
    if (dome_ != nullptr) {
        seen.L += dome.L;
        seen.pdf += (1.0 - sun_share_) * dome.pdf;
    }
    return seen;
}

LightSample sample(const SkyLight& light, Sample2 s, double pick)
{
    return SkyView(light).sample(s, pick);
}

LightSample look(const SkyLight& light, Dir3 wi)
{
    return SkyView(light).look(wi);
}

}  // namespace relight
