#include <cmath>
#include <numbers>

#include "core/check/cases.h"
#include "core/check/meters.h"
#include "core/check/quadrature.h"

// Lights of one direction: point, spot, sun, photometric profile.

namespace relight {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double deg = pi / 180.0;

/// Meters on the sphere of that radius around the origin, facing in, and the areas they stand for:
/// sum of E x area is the flux through the sphere. Gauss-Legendre in z, between the given breaks.
struct Shell {
    std::vector<Meter> meters;
    std::vector<double> areas;

    Shell(double radius, const std::vector<double>& breaks, int turns)
    {
        for (std::size_t b = 0; b + 1 < breaks.size(); ++b) {
            const double middle = 0.5 * (breaks[b] + breaks[b + 1]);
            const double half = 0.5 * (breaks[b + 1] - breaks[b]);
            for (const auto& [x, weight] : quadrature::gauss) {
                for (int j = 0; j < turns; ++j) {
                    const Vec3 out =
                        quadrature::direction(middle + half * x, 2.0 * pi * (j + 0.5) / turns);
                    meters.push_back({Point3{} + out * radius, -out});
                    areas.push_back(radius * radius * weight * half * 2.0 * pi / turns);
                }
            }
        }
    }
    double flux(const Light& light) const
    {
        const auto readings = read(speck(), meters, lit_by({light}));
        double Phi = 0.0;
        for (std::size_t i = 0; i < areas.size(); ++i) { Phi += readings[i].E.value * areas[i]; }
        return Phi;
    }
};

void check_point(Cases& cases)
{
    cases.group("point", "W/m2");
    const double I = 7.0;
    const Light light = light_of(PointLight{{0, 0, 2}, {}}, I);
    cases.relative("point light straight above", "E = I / h^2", I / 4.0,
                   read_one(light, {{0, 0, 0}}).value);
    const double d2 = 4.0 + 1.5 * 1.5;
    cases.relative("point light aside: cosine over distance squared", "E = I h / (h^2 + x^2)^(3/2)",
                   I * 2.0 / (d2 * std::sqrt(d2)), read_one(light, {{0, 1.5, 0}}).value);
    cases.relative("point light on a receiver tilted by 60 degrees", "E = I cos 60 / h^2", I / 8.0,
                   read_one(light, {{0, 0, 0}, {std::sqrt(3.0), 0, 1}}).value);
    cases.exact("point light from behind", "E = 0", 0.0,
                read_one(light, {{0, 0, 3}, {0, 0, 1}}).value);
    const Light ranged = light_of(PointLight{{0, 0, 2}, 3.0}, I);
    cases.relative("point light with a range", "E = I / h^2 (1 - (h / range)^4)",
                   I / 4.0 * (1.0 - 16.0 / 81.0), read_one(ranged, {{0, 0, 0}}).value);
    cases.group("point", "W");
    cases.relative(
        "flux of a point light through a sphere around it (Gauss)",
        "int E dA = 4 pi I, wherever the light stands inside", 4.0 * pi * I,
        Shell(1.0, {-1, -0.5, 0, 0.5, 1}, 48).flux(light_of(PointLight{{0.3, 0.1, -0.2}, {}}, I)));
}

void check_spot(Cases& cases)
{
    cases.group("spot", "W/m2");
    const double I = 5.0, inner = 20.0 * deg, outer = 40.0 * deg;
    const Light light = light_of(SpotLight{{0, 0, 2}, normalize({0, 0, -1}), inner, outer}, I);
    const auto at_angle = [](double angle) {
        return Meter{{2.0 * std::tan(angle), 0, 0}, {-std::sin(angle), 0, std::cos(angle)}};
    };
    const auto facing = [](double angle) { return std::pow(std::cos(angle) / 2.0, 2); };
    cases.relative("spot light inside its inner cone is a point light", "E = I / d^2",
                   I * facing(0.9 * inner), read_one(light, at_angle(0.9 * inner)).value);
    const double middle = std::acos(0.5 * (std::cos(inner) + std::cos(outer)));
    cases.relative("spot light half way down its ramp", "E = I / (4 d^2)",
                   0.25 * I * facing(middle), read_one(light, at_angle(middle)).value);
    cases.exact("spot light outside its outer cone", "E = 0", 0.0,
                read_one(light, at_angle(1.01 * outer)).value);
    cases.group("spot", "W");
    const double ci = std::cos(inner), co = std::cos(outer);
    const Light centred = light_of(SpotLight{{}, normalize({0, 0, 1}), inner, outer}, I);
    cases.relative("flux of a spot light through a sphere around it",
                   "Phi = 2 pi I ((1 - ci) + (ci - co) / 3)",
                   2.0 * pi * I * ((1.0 - ci) + (ci - co) / 3.0),
                   Shell(1.5, {co, ci, 1.0}, 4).flux(centred));
    const SpotLight spot{{}, normalize({0, 0, 1}), inner, outer};
    cases.group("spot", "W/sr");
    cases.relative(
        "intensity of a spot light given by its flux",
        "I = Phi / (2 pi ((1 - ci) + (ci - co) / 3))", I,
        intensity_of_flux(spot, {Rgb::grey(2.0 * pi * I * ((1.0 - ci) + (ci - co) / 3.0))})
            .value.r);
}

void check_sun(Cases& cases)
{
    cases.group("sun", "W/m2");
    const double E_perp = 3.0;
    const auto sun_at = [&](double zenith_angle, double half_angle) {
        return light_of(
            DirectionalLight{normalize({-std::sin(zenith_angle), 0, -std::cos(zenith_angle)}),
                             half_angle},
            E_perp);
    };
    cases.relative("sun 40 degrees from the zenith", "E = E_perp cos 40",
                   E_perp * std::cos(40.0 * deg), read_one(sun_at(40.0 * deg, 0.0), {}).value);
    cases.relative("sun elsewhere on the ground is the same", "E = E_perp cos 40",
                   E_perp * std::cos(40.0 * deg),
                   read_one(sun_at(40.0 * deg, 0.0), {{-37, 21, 0}}).value);
    cases.exact("sun below the horizon", "E = 0", 0.0, read_one(sun_at(91.0 * deg, 0.0), {}).value);
    cases.relative("sun's disc wholly up is its direction", "E = E_perp cos 40",
                   E_perp * std::cos(40.0 * deg),
                   read_one(sun_at(40.0 * deg, 0.2665 * deg), {}).value);
    // Half a cap: L int_0^s sin^2(t) dt int cos(phi) dphi = L (s - sin s cos s), with L = E_perp /
    // (pi sin^2 s).
    for (const double half : {0.2665, 10.0}) {
        const double s = half * deg;
        const double E =
            E_perp * (s - std::sin(s) * std::cos(s)) / (pi * std::sin(s) * std::sin(s));
        cases.relative("disc of half angle " + std::string(half < 1.0 ? "0.2665" : "10") +
                           " degrees, half set",
                       "E = E_perp (s - sin s cos s) / (pi sin^2 s)", E,
                       read_one(sun_at(90.0 * deg, s), {}).value, 1e-5);
    }
}

void check_profile(Cases& cases)
{
    cases.group("ies", "lx");
    const auto ies = [](std::vector<double> vertical, std::vector<double> candela) {
        return std::make_shared<const IesProfile>(
            IesProfile{std::move(vertical), {0.0}, std::move(candela)});
    };
    const auto isotropic = ies({0, 90, 180}, {250, 250, 250});
    const auto wedge = ies({0, 90}, {1000, 0});  // falls evenly with the angle
    const auto lamp = [](std::shared_ptr<const IesProfile> profile) {
        return light_of(
            IesLight{{0, 0, 2}, normalize({0, 0, -1}), normalize({1, 0, 0}), std::move(profile)});
    };
    cases.relative("isotropic profile is a point light", "E = I h / (h^2 + x^2)^(3/2)",
                   250.0 * 2.0 / std::pow(5.0, 1.5), read_one(lamp(isotropic), {{1, 0, 0}}).value);
    cases.relative("profile that falls evenly, read at 45 degrees", "E = (I0 / 2) cos 45 / (2 h^2)",
                   500.0 * std::sqrt(0.5) / 8.0, read_one(lamp(wedge), {{0, -2, 0}}).value);
    cases.group("ies", "lm");
    cases.relative("flux of an isotropic profile", "Phi = 4 pi I", 4.0 * pi * 250.0,
                   flux(*isotropic), 1e-9);
    cases.relative("flux of a profile that falls evenly to 90 degrees", "Phi = 2 pi I0 (1 - 2/pi)",
                   2.0 * pi * 1000.0 * (1.0 - 2.0 / pi), flux(*wedge), 1e-9);
}

}  // namespace

void check_points(Cases& cases)
{
    check_point(cases);
    check_spot(cases);
    check_sun(cases);
    check_profile(cases);
}

}  // namespace relight
