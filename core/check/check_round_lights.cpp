#include <cmath>
#include <numbers>

#include "core/check/cases.h"
#include "core/check/meters.h"
#include "core/check/quadrature.h"

// Balls and disks.

namespace relight {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double L = 2.0;

/// E of a uniform cap of half angle s whose axis stands at beta from the normal, ring by ring.
double cap_by_rings(double s, double beta)
{
    const auto ring = [&](double t) {
        return std::sin(t) * quadrature::positive_turn(std::cos(beta) * std::cos(t),
                                                       std::sin(beta) * std::sin(t));
    };
    const double meets = std::abs(0.5 * pi - beta);  // the ring that touches the horizon
    return quadrature::over_interval(ring, 0.0, meets, 20) +
           quadrature::over_interval(ring, meets, s, 2000);
}

void check_sphere(Cases& cases)
{
    cases.group("sphere", "W/m2");
    const double R = 0.5;
    const auto ball_at = [&](Point3 centre) { return light_of(SphereLight{centre, R}, L); };
    cases.relative("ball above the horizon is a point light", "E = pi R^2 L cos / d^2",
                   pi * R * R * L * 2.0 / std::pow(5.0, 1.5),
                   read_one(ball_at({1, 0, 2}), {}).value);
    cases.relative("ball so near that it is all but touched", "E = pi R^2 L / d^2",
                   pi * R * R * L / (0.501 * 0.501), read_one(ball_at({0, 0, 0.501}), {}).value);
    cases.relative("ball that touches and faces the receiver", "E -> pi L", pi * L,
                   read_alone(ball_at({0, 0, R * (1.0 + 1e-9)}), {}));
    const double s = std::asin(R / 0.8);
    cases.relative("ball whose middle is on the horizon", "E = L (s - sin s cos s), sin s = R / d",
                   L * (s - std::sin(s) * std::cos(s)), read_alone(ball_at({0.8, 0, 0}), {}));
    for (const double beta : {1.2, 1.9}) {
        cases.relative(beta < 1.5 ? "ball of which the horizon hides a piece"
                                  : "ball of which the horizon leaves a piece",
                       "E = L int cos dw over the visible cap, ring by ring",
                       L * cap_by_rings(s, beta),
                       read_alone(ball_at({0.8 * std::sin(beta), 0, 0.8 * std::cos(beta)}), {}));
    }
    cases.exact("ball below the horizon", "E = 0", 0.0, read_alone(ball_at({0, 0.8, -0.6}), {}));
    cases.exact("receiver inside the ball, which shines outward", "E = 0", 0.0,
                read_alone(ball_at({0, 0, 0.3}), {}));
}

void check_disk(Cases& cases)
{
    cases.group("disk", "W/m2");
    const double R = 0.7, h = 1.1;
    const auto above = [&](double x, double radius) {
        return light_of(DiskLight{{x, 0, h}, normalize({0, 0, -1}), radius}, L);
    };
    cases.relative("disk on its axis", "E = pi L R^2 / (R^2 + h^2)",
                   pi * L * R * R / (R * R + h * h), read_one(above(0, R), {}).value);
    cases.relative("endless disk", "E -> pi L", pi * L, read_one(above(0, 1e4), {}).value, 2e-6);
    const double x = 1.9;
    {  // Siegel & Howell; lengths in units of the distance from the axis
        const double H = h / x, r = R / x, Z = 1.0 + H * H + r * r;
        const double root = std::sqrt(Z * Z - 4.0 * r * r);
        cases.relative("disk off its axis, parallel",
                       "E = pi L/2 (1 - (Z - 2 r^2) / sqrt(Z^2 - 4 r^2)), Z = 1 + H^2 + r^2",
                       pi * L * 0.5 * (1.0 - (Z - 2.0 * r * r) / root),
                       read_one(above(x, R), {}).value);
        cases.relative(
            "disk off its axis, at right angles", "E = pi L H/2 (Z / sqrt(Z^2 - 4 r^2) - 1)",
            pi * L * 0.5 * H * (Z / root - 1.0), read_alone(above(x, R), {{}, {1, 0, 0}}));
    }
    cases.relative("disk that the horizon cuts in half", "E = L (atan(R/h) - h R / (R^2 + h^2))",
                   L * (std::atan(R / h) - h * R / (R * R + h * h)),
                   read_alone(above(0, R), {{}, {1, 0, 0}}));
    cases.exact("disk that faces away", "E = 0", 0.0,
                read_one(light_of(DiskLight{{0, 0, h}, normalize({0, 0, 1}), R}, L), {}).value);
}

}  // namespace

void check_round_lights(Cases& cases)
{
    check_sphere(cases);
    check_disk(cases);
}

}  // namespace relight
