#include "core/light/temperature.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace relight {
namespace {

struct Chromaticity {
    double x, y;
};

/// CIE x, y of linear Rec.709: its matrix to XYZ (ITU-R BT.709).
Chromaticity chromaticity(Rgb c)
{
    const double X = 0.4124564 * c.r + 0.3575761 * c.g + 0.1804375 * c.b;
    const double Y = luminance(c);
    const double Z = 0.0193339 * c.r + 0.1191920 * c.g + 0.9503041 * c.b;
    return {X / (X + Y + Z), Y / (X + Y + Z)};
}

/// The Planckian locus as Kim et al. fitted it to tables (US patent 7024034, 2006), 1667..25000 K.
Chromaticity planckian(double T)
{
    const double t = 1e3 / T;
    const double x = T <= 4000.0 ? ((-0.2661239 * t - 0.2343589) * t + 0.8776956) * t + 0.179910
                                 : ((-3.0258469 * t + 2.1070379) * t + 0.2226347) * t + 0.240390;
    const double y = T <= 2222.0 ? ((-1.1063814 * x - 1.34811020) * x + 2.18555832) * x - 0.20219683
                     : T <= 4000.0
                         ? ((-0.9549476 * x - 1.37418593) * x + 2.09137015) * x - 0.16748867
                         : ((3.0817580 * x - 5.87338670) * x + 3.75112997) * x - 0.37001483;
    return {x, y};
}

/// From `first` in steps of `ratio` up to the largest [K].
std::vector<double> temperatures(double first, double ratio)
{
    std::vector<double> all{first};
    while (all.back() * ratio <= largest_temperature_k) { all.push_back(all.back() * ratio); }
    return all;
}

TEST(Temperature, HasLuminanceOneAndNoNegativeBand)
{
    for (const double T : temperatures(least_temperature_k, 1.01)) {
        const Rgb c = blackbody(T);
        EXPECT_NEAR(luminance(c), 1.0, 1e-12) << T;
        EXPECT_TRUE(c.r >= 0.0 && c.g >= 0.0 && c.b >= 0.0) << T;
    }
}

TEST(Temperature, LiesOnThePlanckianLocus)
{
    // The observer's fit is good to some thousandths of x and y.
    for (const double T : {2000.0, 2856.0, 4000.0, 5000.0, 6504.0, 10000.0, 20000.0}) {
        const Chromaticity is = chromaticity(blackbody(T)), should = planckian(T);
        EXPECT_NEAR(is.x, should.x, 0.003) << T;
        EXPECT_NEAR(is.y, should.y, 0.003) << T;
    }
    const Chromaticity illuminant_a = chromaticity(blackbody(2855.5));  // by its CIE definition
    EXPECT_NEAR(illuminant_a.x, 0.44757, 0.003);
    EXPECT_NEAR(illuminant_a.y, 0.40745, 0.003);
}

TEST(Temperature, HotterIsBluer)
{
    double red = 1e9, blue = -1.0;
    for (const double T : temperatures(least_temperature_k, 1.1)) {
        const Rgb c = blackbody(T);
        EXPECT_LT(c.r, red) << T;
        EXPECT_GE(c.b, blue) << T;
        red = c.r;
        blue = c.b;
    }
}

TEST(Temperature, IsOutOfGamutOnlyBelowAbout1900K)
{
    EXPECT_EQ(blackbody(1000.0).b, 0.0);
    EXPECT_EQ(blackbody(1800.0).b, 0.0);
    for (const double T : temperatures(2000.0, 1.1)) { EXPECT_GT(blackbody(T).b, 0.0) << T; }
}

TEST(Temperature, NearTheWhitePointTheBandsAreNearlyEqual)
{
    // D65 lies a little above the locus, nearest at 6504 K: greens are some per cent short.
    const Rgb c = blackbody(6504.0);
    EXPECT_NEAR(c.r, 1.0, 0.06);
    EXPECT_NEAR(c.g, 1.0, 0.06);
    EXPECT_NEAR(c.b, 1.0, 0.06);
}

}  // namespace
}  // namespace relight
