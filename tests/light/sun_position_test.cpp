#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "core/light/sky.h"

namespace relight {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double degree = pi / 180.0;

struct Horizontal {
    double altitude, azimuth;  ///< degrees; azimuth clockwise from north
};
Horizontal sun(double latitude_deg, double longitude_deg, std::string_view time)
{
    const std::optional<double> seconds = rfc3339(time);
    EXPECT_TRUE(seconds) << time;
    const Dir3 w = toward_sun(latitude_deg * degree, longitude_deg * degree, seconds.value_or(0.0));
    EXPECT_NEAR(length(w), 1.0, 1e-14);
    const double azimuth = std::atan2(w.x(), -w.z()) / degree;
    return {std::asin(w.y()) / degree, azimuth < 0.0 ? azimuth + 360.0 : azimuth};
}

TEST(SunPosition, FromThePoleItsAltitudeIsItsDeclination)
{
    // Instants of solstices and equinoxes: US Naval Observatory.
    EXPECT_NEAR(sun(90, 0, "2024-03-20T03:06:00Z").altitude, 0.0, 0.02);
    EXPECT_NEAR(sun(90, 0, "2024-06-20T20:51:00Z").altitude, 23.437, 0.02);
    EXPECT_NEAR(sun(90, 0, "2024-09-22T12:44:00Z").altitude, 0.0, 0.02);
    EXPECT_NEAR(sun(90, 0, "2024-12-21T09:20:00Z").altitude, -23.437, 0.02);
    EXPECT_NEAR(sun(90, 0, "2000-03-20T07:35:00Z").altitude, 0.0, 0.02);
    EXPECT_NEAR(sun(90, 0, "2000-06-21T01:48:00Z").altitude, 23.438, 0.02);
    EXPECT_NEAR(sun(-90, 0, "2000-12-21T13:37:00Z").altitude, 23.438, 0.02);
    // Meeus 1998, example 25.b: apparent declination -7 47' 01.74"
    EXPECT_NEAR(sun(90, 0, "1992-10-13T00:00:00Z").altitude, -7.78382, 0.02);
}

TEST(SunPosition, AgreesWithThePublishedExampleOfTheSolarPositionAlgorithm)
{
    // Reda & Andreas 2004 (NREL/TP-560-34302), table A5.1: before refraction e0 = 39.872046,
    // azimuth 194.340241 degrees.
    const Horizontal at = sun(39.742476, -105.1786, "2003-10-17T12:30:30-07:00");
    EXPECT_NEAR(at.altitude, 39.872046, 0.02);
    EXPECT_NEAR(at.azimuth, 194.340241, 0.02);
}

TEST(SunPosition, AtGreenwichItIsSouthWhenTheEquationOfTimeSays)
{
    // Clock time of the meridian passage: 12:00 less the equation of time, at its extremes of the
    // year and where it vanishes (a minute of time turns the sun by 0.25 degrees of hour angle).
    for (const char* passage :
         {"2024-02-11T12:14:13Z", "2024-11-03T11:43:34Z", "2024-05-14T11:56:20Z",
          "2024-07-26T12:06:32Z", "2024-12-25T12:00:00Z"}) {
        EXPECT_NEAR(sun(51.4779, 0.0, passage).azimuth, 180.0, 0.2) << passage;
    }
}

TEST(SunPosition, RisesInTheEastAndIsHighestOnTheMeridian)
{
    const double noon = rfc3339("2024-11-03T11:43:34Z").value_or(0.0);
    for (const double latitude : {60.0, 35.0, -35.0, -60.0}) {
        const Dir3 at_noon = toward_sun(latitude * degree, 0.0, noon);
        EXPECT_NEAR(at_noon.x(), 0.0, 0.003);
        EXPECT_EQ(at_noon.z() > 0.0, latitude > 0.0);  // south from the north, north from the south
        for (const double hours : {1.0, 3.0, 5.0}) {
            const Dir3 before = toward_sun(latitude * degree, 0.0, noon - 3600.0 * hours);
            const Dir3 after = toward_sun(latitude * degree, 0.0, noon + 3600.0 * hours);
            EXPECT_GT(before.x(), 0.1);  // east in the morning
            EXPECT_LT(after.x(), -0.1);
            // The day is symmetric but for what declination does meanwhile (0.3 degrees a day).
            EXPECT_NEAR(before.y(), after.y(), 0.004);
            EXPECT_NEAR(before.x(), -after.x(), 0.004);
            EXPECT_LT(before.y(), at_noon.y());
        }
    }
}

TEST(SunPosition, NoonIsHighInJulyAndLowInJanuaryInTheNorth)
{
    const double july = sun(48.0, 0.0, "2026-07-15T12:06:00Z").altitude;
    const double january = sun(48.0, 0.0, "2026-01-15T12:09:00Z").altitude;
    EXPECT_NEAR(july, 90.0 - 48.0 + 21.5, 0.3);  // 90 - latitude + declination
    EXPECT_NEAR(january, 90.0 - 48.0 - 21.1, 0.3);
    EXPECT_GT(sun(70.0, 20.0, "2026-06-21T22:40:00Z").altitude, 0.0);  // midnight sun
    EXPECT_LT(sun(70.0, 20.0, "2026-12-21T10:40:00Z").altitude, 0.0);  // polar night
    EXPECT_NEAR(sun(0.0, 0.0, "2026-03-20T12:07:30Z").altitude, 90.0, 0.3);
}

TEST(SunPosition, FifteenDegreesOfLongitudeAreAnHour)
{
    const Horizontal here = sun(45.0, 0.0, "2026-05-01T10:00:00Z");
    const Horizontal there = sun(45.0, 30.0, "2026-05-01T08:00:00Z");
    EXPECT_NEAR(here.altitude, there.altitude, 0.05);
    EXPECT_NEAR(here.azimuth, there.azimuth, 0.05);
}

TEST(Rfc3339, TellsTheSecondsSince1970)
{
    EXPECT_EQ(rfc3339("1970-01-01T00:00:00Z"), 0.0);
    EXPECT_EQ(rfc3339("2000-01-01T12:00:00Z"), 946728000.0);
    EXPECT_EQ(rfc3339("2038-01-19T03:14:08Z"), 2147483648.0);
    EXPECT_EQ(rfc3339("1969-12-31T23:59:59Z"), -1.0);
    EXPECT_EQ(rfc3339("2000-02-29T00:00:00Z"), 951782400.0);
    EXPECT_EQ(rfc3339("1900-01-01T00:00:00Z"), -2208988800.0);
    EXPECT_EQ(rfc3339("2026-06-21t12:00:00z"), rfc3339("2026-06-21T12:00:00Z"));
}

TEST(Rfc3339, OffsetsNameTheSameInstant)  // pairs from RFC 3339, section 5.8
{
    EXPECT_EQ(rfc3339("1996-12-19T16:39:57-08:00"), rfc3339("1996-12-20T00:39:57Z"));
    EXPECT_EQ(rfc3339("1990-12-31T15:59:60-08:00"), rfc3339("1990-12-31T23:59:60Z"));
    EXPECT_EQ(rfc3339("2026-06-21T12:00:00+02:00"), rfc3339("2026-06-21T10:00:00Z"));
    EXPECT_EQ(rfc3339("2026-06-21T12:00:00-00:00"), rfc3339("2026-06-21T12:00:00Z"));
    EXPECT_EQ(rfc3339("2026-01-01T00:30:00+23:59"), rfc3339("2025-12-31T00:31:00Z"));
}

TEST(Rfc3339, FractionsAndLeapSecondsCount)
{
    EXPECT_NEAR(rfc3339("1985-04-12T23:20:50.52Z").value_or(0.0) -
                    rfc3339("1985-04-12T23:20:50Z").value_or(1.0),
                0.52, 1e-6);
    EXPECT_TRUE(rfc3339("1937-01-01T12:00:27.87+00:20"));
    EXPECT_TRUE(rfc3339("2026-06-21T12:00:00." + std::string(1000, '9') + "Z"));
    EXPECT_EQ(rfc3339("1990-12-31T23:59:60Z"), rfc3339("1991-01-01T00:00:00Z"));
}

TEST(Rfc3339, RefusesWhatIsNotATime)
{
    for (const char* text : {"",
                             "2026",
                             "2026-06-21",
                             "2026-06-21T12:00:00",
                             "2026-06-21T12:00Z",
                             "2026-06-21 12:00:00Z",
                             " 2026-06-21T12:00:00Z",
                             "2026-06-21T12:00:00Z ",
                             "2026-6-21T12:00:00Z",
                             "26-06-21T12:00:00Z",
                             "02026-06-21T12:00:00Z",
                             "2026-06-21T12:00:00.Z",
                             "2026-06-21T12:00:00,5Z",
                             "2026-06-21T12:00:00+2:00",
                             "2026-06-21T12:00:00+0200",
                             "2026-06-21T12:00:00+02",
                             "2026-06-21T12:00:00+02:00Z",
                             "2026-06-21T12:00:00+24:00",
                             "2026-06-21T12:00:00+02:60",
                             "2026-06-21T24:00:00Z",
                             "2026-06-21T12:60:00Z",
                             "2026-06-21T12:00:61Z",
                             "2026-06-21T12:00:60Z",
                             "1990-12-31T23:59:60-08:00",
                             "2026-00-21T12:00:00Z",
                             "2026-13-21T12:00:00Z",
                             "2026-06-00T12:00:00Z",
                             "2026-06-31T12:00:00Z",
                             "2026-02-29T12:00:00Z",
                             "2100-02-29T12:00:00Z",
                             "1899-12-31T12:00:00Z",
                             "2200-01-01T00:00:00Z",
                             "+026-06-21T12:00:00Z",
                             "2026-+6-21T12:00:00Z",
                             "2026/06/21T12:00:00Z",
                             "2026-06-21T12-00-00Z",
                             "2026-06-21T12:00:00.5",
                             "2026-06-21T-1:00:00Z",
                             "Z",
                             "T"}) {
        EXPECT_FALSE(rfc3339(text)) << text;
    }
    EXPECT_FALSE(rfc3339(std::string_view("2026-06-21T12:00:00Z\0", 21)));
    EXPECT_TRUE(rfc3339("2024-02-29T12:00:00Z"));
    EXPECT_TRUE(rfc3339("2199-12-31T23:59:59Z"));
    const std::string whole = "2026-06-21T12:00:00.25+02:00";
    for (std::size_t n = 0; n < whole.size(); ++n) { EXPECT_FALSE(rfc3339(whole.substr(0, n))); }
}

}  // namespace
}  // namespace relight
