#include "core/light/temperature.h"

#include <cmath>

#include "core/light/xyz.h"

namespace relight {
namespace {

/// A bell whose two sides have widths of their own: `below` and `above` are 1 / sigma [1/nm].
double lobe(double nm, double height, double centre, double below, double above)
{
    const double t = (nm - centre) * (nm < centre ? below : above);
    return height * std::exp(-0.5 * t * t);
}

/// CIE 1931 2-degree observer.   Wyman, Sloan & Shirley 2013, "Simple analytic approximations to
/// the CIE XYZ color matching functions", the multi-lobe fits
Xyz observer(double nm)
{
    return {lobe(nm, 0.362, 442.0, 0.0624, 0.0374) + lobe(nm, 1.056, 599.8, 0.0264, 0.0323) +
                lobe(nm, -0.065, 501.1, 0.0490, 0.0382),
            lobe(nm, 0.821, 568.8, 0.0213, 0.0247) + lobe(nm, 0.286, 530.9, 0.0613, 0.0322),
            lobe(nm, 1.217, 437.0, 0.0845, 0.0278) + lobe(nm, 0.681, 459.0, 0.0385, 0.0725)};
}

/// Planck's spectral radiance over wavelength, relative to that at 560 nm: 1000 K and 40000 K are
/// then alike in size.
double planck(double nm, double kelvin)
{
    constexpr double c2 = 1.438776877e7;  // second radiation constant h c / k [nm K], SI 2019
    constexpr double reference = 560.0;
    const double ratio = reference / nm;
    return std::pow(ratio, 5.0) * std::expm1(c2 / (reference * kelvin)) /
           std::expm1(c2 / (nm * kelvin));
}

}  // namespace

Rgb blackbody(double kelvin)
{
    Xyz sum;
    // A smooth integrand that is next to nothing at both ends: equal steps converge at once.
    for (int nm = 360; nm <= 830; nm += 5) {
        const double power = planck(nm, kelvin);
        const Xyz bar = observer(nm);
        sum.X += power * bar.X;
        sum.Y += power * bar.Y;
        sum.Z += power * bar.Z;
    }
    const Rgb colour = rec709(sum);
    return colour / luminance(colour);
}

}  // namespace relight
