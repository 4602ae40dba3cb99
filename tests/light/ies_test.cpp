#include "core/light/ies.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <sstream>

#include "core/light/light.h"
#include "tests/light/monte_carlo.h"
#include "tests/oracle.h"

namespace relight {
namespace {

using nlohmann::json;

constexpr double pi = std::numbers::pi;

/// The numbers of a well-formed LM-63 text. (The service reads files in io/, strictly.)
IesProfile profile_of(const std::string& text)
{
    std::istringstream in(text.substr(text.find("TILT=NONE") + 9));
    const auto numbers = [&](std::size_t n) {
        std::vector<double> values(n);
        for (double& value : values) { in >> value; }
        return values;
    };
    const std::vector<double> head = numbers(13);
    IesProfile profile;
    profile.vertical_deg = numbers(static_cast<std::size_t>(head[3]));
    profile.horizontal_deg = numbers(static_cast<std::size_t>(head[4]));
    profile.candela = numbers(profile.vertical_deg.size() * profile.horizontal_deg.size());
    for (double& candela : profile.candela) { candela *= head[2] * head[10]; }
    EXPECT_FALSE(in.fail());
    return profile;
}

std::map<std::string, std::shared_ptr<const IesProfile>> profiles(const json& file)
{
    std::map<std::string, std::shared_ptr<const IesProfile>> all;
    for (const json& p : file["profiles"]) {
        all[p["name"]] = std::make_shared<const IesProfile>(profile_of(p["text"]));
    }
    return all;
}

TEST(IesOracle, EveryCaseHasItsIntensityIrradianceAndFlux)
{
    const json file = test::oracle("lights_ies");
    const auto all = profiles(file);
    const test::Tolerance tolerance(file["tolerance"]), strict(1e-9, 1e-12), tight(1e-6, 0.0);
    std::size_t checked = 0;
    for (const json& c : file["cases"]) {
        SCOPED_TRACE(c["id"].get<std::string>());
        const auto& profile = all.at(c["profile"]);
        ++checked;
        if (c.contains("total_flux_lm")) {
            const double Phi = flux(*profile), expected = c["total_flux_lm"];
            EXPECT_TRUE(tight.holds(Phi, expected)) << Phi << " for " << expected;
            continue;
        }
        const auto direction = [&](const char* key) { return normalize(test::vec_of(c[key])); };
        const IesLight light{test::point_of(c["position"]), direction("axis"), direction("h0"),
                             profile};
        const Arrival arrival = arrive(light, test::point_of(c["p"]));
        const double I = intensity(*profile, c["vertical_deg"], c["horizontal_deg"]);
        const double E = arrival.per_unit * std::max(0.0, dot(direction("n"), arrival.wi));
        for (const auto& [x, e] : {std::pair{I, c["I_cd"].get<double>()},
                                   {intensity_toward(light, arrival.wi), c["I_cd"].get<double>()},
                                   {E, c["E"].get<double>()}}) {
            EXPECT_TRUE(tolerance.holds(x, e)) << x << " for " << e;
            EXPECT_TRUE(strict.holds(x, e)) << x << " for " << e;
        }
    }
    EXPECT_EQ(checked, file["case_count"].get<std::size_t>());
}

TEST(Ies, FluxIsTheIntegralOfTheIntensity)
{
    for (const auto& [name, profile] : profiles(test::oracle("lights_ies"))) {
        // Midpoints of steps that fit the tables' kinks (whole and half degrees).
        constexpr int rows = 1440, columns = 720;
        double sum = 0.0;
        for (int i = 0; i < rows; ++i) {
            const double theta = 180.0 * (i + 0.5) / rows;
            double ring = 0.0;
            for (int j = 0; j < columns; ++j) {
                ring += intensity(*profile, theta, 360.0 * (j + 0.5) / columns - 180.0);
            }
            sum += ring * std::sin(theta * pi / 180.0);
        }
        sum *= pi / rows * 2.0 * pi / columns;
        EXPECT_NEAR(flux(*profile) / sum, 1.0, 2e-6) << name;
    }
}

TEST(Ies, AnIsotropicProfileIsAPointLight)
{
    const std::vector<double> v{0, 30, 90, 180};
    for (const std::vector<double>& h :
         {std::vector<double>{0}, {0, 90}, {0, 60, 180}, {90, 180, 270}, {0, 120, 240, 360}}) {
        const auto profile = std::make_shared<const IesProfile>(
            IesProfile{v, h, std::vector<double>(v.size() * h.size(), 7.5)});
        EXPECT_NEAR(flux(*profile), 4.0 * pi * 7.5, 1e-12 * 100.0);
        const Point3 position{1, -2, 0.5};
        for (int i = 0; i < 200; ++i) {
            const auto u = [&](std::uint64_t k) {
                return 2.0 * uniform(4, 0, static_cast<std::uint64_t>(i), k) - 1.0;
            };
            const IesLight light{position, normalize({u(0), u(1), u(2)}),
                                 normalize({u(3), u(4), u(5)}), profile};
            const Point3 p = position + Vec3{u(6), u(7), u(8)} * 3.0;
            EXPECT_NEAR(
                arrive(light, p).per_unit / (7.5 * arrive(PointLight{position, {}}, p).per_unit),
                1.0, 1e-12);
        }
    }
}

/// The value at a knot is 100 h + v: wherever it is asked, the answer tells where it was read.
IesProfile telling(const std::vector<double>& horizontal)
{
    IesProfile profile{{0, 45, 90}, horizontal, {}};
    for (const double h : horizontal) {
        for (const double v : profile.vertical_deg) { profile.candela.push_back(100.0 * h + v); }
    }
    return profile;
}

TEST(Ies, SymmetriesFoldTheHorizontalAngle)
{
    const auto read_at = [](const std::vector<double>& horizontal, double h) {
        return (intensity(telling(horizontal), 20.0, h) - 20.0) / 100.0;
    };
    for (const double turns : {-720.0, -360.0, 0.0, 360.0}) {
        for (const double h : {0.0, 10.0, 80.0, 90.0}) {
            for (const double same : {h, 180.0 - h, 180.0 + h, 360.0 - h, -h}) {
                EXPECT_NEAR(read_at({0, 30, 90}, same + turns), h, 1e-9) << same;
            }
        }
        for (const double h : {0.0, 10.0, 100.0, 180.0}) {
            for (const double same : {h, 360.0 - h, -h}) {
                EXPECT_NEAR(read_at({0, 30, 180}, same + turns), h, 1e-9) << same;
            }
        }
        for (const double h : {90.0, 100.0, 180.0, 260.0, 270.0}) {
            for (const double same : {h, 180.0 - h, 540.0 - h}) {  // mirrored in the 90-270 plane
                EXPECT_NEAR(read_at({90, 135, 270}, same + turns), h, 1e-9) << same;
            }
        }
        for (const double h : {0.0, 10.0, 100.0, 200.0, 359.0}) {
            EXPECT_NEAR(read_at({0, 30, 90, 360}, h + turns), h, 1e-9);
        }
    }
}

TEST(Ies, IsBilinearBetweenKnotsAndNothingOutsideTheVerticalRange)
{
    const IesProfile profile{{30, 60}, {0, 40, 360}, {1, 3, 5, 11, 1, 3}};
    EXPECT_NEAR(intensity(profile, 30, 0), 1.0, 1e-12);
    EXPECT_NEAR(intensity(profile, 60, 40), 11.0, 1e-12);
    EXPECT_NEAR(intensity(profile, 45, 20), 0.25 * (1 + 3 + 5 + 11), 1e-12);
    EXPECT_NEAR(intensity(profile, 60, 200), 7.0, 1e-12);  // half way on from 40 to 360
    EXPECT_EQ(intensity(profile, 29.999, 20), 0.0);
    EXPECT_EQ(intensity(profile, 60.001, 20), 0.0);
}

TEST(Ies, HorizontalAnglesRunFromH0TowardMinusAxisCrossH0)
{
    // Shining down, 0 toward +X: 90 degrees is cross(+Y, +X) = -Z, counter-clockwise seen from
    // above.
    const IesProfile quarters{
        {0, 90, 180}, {0, 90, 180, 270, 360}, {1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4, 1, 1, 1}};
    const IesLight light{{},
                         normalize({0, -1, 0}),
                         normalize({1, 0, 0}),
                         std::make_shared<const IesProfile>(quarters)};
    const auto toward = [&](double x, double y, double z) {
        return intensity_toward(light, -normalize({x, y, z}));
    };
    EXPECT_NEAR(toward(1, -0.3, 0), 1.0, 1e-12);
    EXPECT_NEAR(toward(0, -0.3, -1), 2.0, 1e-12);
    EXPECT_NEAR(toward(-1, -0.3, 0), 3.0, 1e-12);
    EXPECT_NEAR(toward(0, -0.3, 1), 4.0, 1e-12);
}

TEST(Ies, AnH0AskewToTheAxisCountsByItsPerpendicularPart)
{
    const auto profile = std::make_shared<const IesProfile>(telling({0, 120, 240, 360}));
    const Dir3 axis = normalize({0.2, -1, 0.4});
    const Frame frame = frame_around(axis);
    const IesLight right{{}, axis, frame.x, profile};
    const IesLight askew{{}, axis, normalize(Vec3(frame.x) + Vec3(axis) * 1.7), profile};
    for (int i = 0; i < 100; ++i) {
        const Sample2 s = test::draw(6, i).s;
        const Dir3 wi = normalize({2.0 * s.u - 1.0, 2.0 * s.v - 1.0, 0.3});
        EXPECT_NEAR(intensity_toward(askew, wi), intensity_toward(right, wi), 1e-6);
    }
}

TEST(Ies, IsFiniteAndNotNegativeWhateverItIsAsked)
{
    std::vector<IesProfile> odd{telling({0, 0}),
                                telling({0}),
                                telling({45}),
                                {{90}, {0}, {3}},  // one angle: no solid angle, no flux
                                {{0, 0, 90, 90}, {0, 90, 90, 360}, std::vector<double>(16, 2.0)}};
    for (const auto& [name, profile] : profiles(test::oracle("lights_ies"))) {
        odd.push_back(*profile);
    }
    const double s = 1e-9;
    const std::vector<Vec3> directions{{0, 1, 0},  {0, -1, 0}, {s, -1, 0},   {s, 1, -s},
                                       {1, 0, 0},  {-1, 0, 0}, {-1, 0, -s},  {-1, -0.0, 0},
                                       {0, 0, -1}, {1, 1, 1},  {-s, -1, -s}, {1, -s, 0}};
    for (const IesProfile& profile : odd) {
        EXPECT_TRUE(std::isfinite(flux(profile)) && flux(profile) >= 0.0);
        for (const Vec3& h0 : {Vec3{1, 0, 0}, Vec3{0, 1, 0}}) {  // the latter: along the axis
            const IesLight light{{},
                                 normalize({0, -1, 0}),
                                 normalize(h0),
                                 std::make_shared<const IesProfile>(profile)};
            for (const Vec3& w : directions) {
                const double I = intensity_toward(light, normalize(w));
                EXPECT_TRUE(std::isfinite(I) && I >= 0.0);
            }
        }
    }
    EXPECT_EQ(flux(odd[3]), 0.0);
}

}  // namespace
}  // namespace relight
