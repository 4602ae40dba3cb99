#include <cmath>
#include <numbers>

#include "core/light/sky.h"

namespace relight {

// Meeus 1998, "Astronomical Algorithms": chapter 25, the sun with low accuracy (0.01 degrees, the
// planets' pull and what differs between UTC and dynamical time left out), chapter 12, sidereal
// time.
Dir3 toward_sun(double latitude, double longitude, double unix_seconds)
{
    constexpr double degree = std::numbers::pi / 180.0;
    constexpr double j2000 = 946728000.0;  // 2000-01-01 12:00 UTC [s since 1970]
    const double days = (unix_seconds - j2000) / 86400.0;
    const double T = days / 36525.0;  // [Julian centuries]

    const double mean_longitude = 280.46646 + T * (36000.76983 + T * 0.0003032);
    const double M = degree * (357.52911 + T * (35999.05029 - T * 0.0001537));  // mean anomaly
    const double centre = (1.914602 - T * (0.004817 + T * 0.000014)) * std::sin(M) +
                          (0.019993 - T * 0.000101) * std::sin(2.0 * M) +
                          0.000289 * std::sin(3.0 * M);
    const double node = degree * (125.04 - 1934.136 * T);  // of the moon's orbit
    const double nutation = -0.00478 * std::sin(node);     // in longitude [degrees]
    constexpr double aberration = -0.00569;
    const double lambda = degree * (mean_longitude + centre + aberration + nutation);
    const double obliquity = degree * (23.439291 - 0.013004 * T + 0.00256 * std::cos(node));

    const double right_ascension =
        std::atan2(std::cos(obliquity) * std::sin(lambda), std::cos(lambda));
    const double sin_declination = std::sin(obliquity) * std::sin(lambda);
    const double cos_declination = std::sqrt((1.0 - sin_declination) * (1.0 + sin_declination));
    const double sidereal = degree * (280.46061837 + 360.98564736629 * days + 0.000387933 * T * T +
                                      nutation * std::cos(obliquity));
    const double H = sidereal + longitude - right_ascension;  // hour angle, west of the meridian

    const double east = -cos_declination * std::sin(H);
    const double north =
        std::cos(latitude) * sin_declination - std::sin(latitude) * cos_declination * std::cos(H);
    const double up =
        std::sin(latitude) * sin_declination + std::cos(latitude) * cos_declination * std::cos(H);
    return normalize({east, up, -north});
}

}  // namespace relight
