#include <cmath>
#include <numbers>

#include "core/check/cases.h"
#include "core/check/meters.h"
#include "core/light/triangle.h"

// What lights draw, and the densities that they say it has: where the walk knows a closed form it
// takes only shares from them, so they are checked by themselves here.

namespace relight {
namespace {

constexpr double pi = std::numbers::pi;
constexpr std::uint32_t points = 4096;

/// Means over the light's samples at the origin.
struct Means {
    double E = 0.0;            ///< of L cos / pdf: irradiance facing +z
    double solid_angle = 0.0;  ///< of 1 / pdf: what the samples fill
    double mismatch = 0.0;     ///< largest |pdf / look's - 1|
};
Means means(const LightShape& shape)
{
    const Sequence sequence(1, 2, 3, 4);
    Means m;
    for (std::uint32_t i = 0; i < points; ++i) {
        const LightSample there = sample(shape, {}, sequence.at(i, 0), sequence.at(i, 1).u);
        if (!there.wi || !(there.pdf > 0.0)) { continue; }
        m.solid_angle += 1.0 / there.pdf / points;
        m.E += there.L.r * std::max(0.0, there.wi.z()) / there.pdf / points;
        const double seen = look(shape, {}, there.wi).pdf;
        m.mismatch = std::max(m.mismatch, std::abs(seen / there.pdf - 1.0));
    }
    return m;
}

}  // namespace

void check_light_samples(Cases& cases)
{
    const double R = 0.5, d = 1.3;
    const double a = 1.0, b = 2.0, h = 1.5;  // half sides of the rectangle, its distance
    const double A = std::hypot(a, h), B = std::hypot(b, h);
    const double sun = 0.1;
    const Dir3 down = normalize({0, 0, -1});
    Image white{16, 8, std::vector<Rgbf>(128, {1.0F, 1.0F, 1.0F}), {}};
    struct Row {
        std::string name;
        LightShape shape;
        std::string E_formula;
        double E;
        std::string angle_formula;
        double solid_angle;
    };
    const std::vector<Row> rows{
        {"rectangle", RectLight{{0, 0, h}, {0, 2 * b, 0}, {2 * a, 0, 0}, false},
         "E = 2 (a/A atan(b/A) + b/B atan(a/B))",
         2.0 * (a / A * std::atan(b / A) + b / B * std::atan(a / B)),
         "Omega = 4 atan(a b / (h sqrt(a^2 + b^2 + h^2)))",
         4.0 * std::atan(a * b / (h * std::sqrt(a * a + b * b + h * h)))},
        {"ball", SphereLight{{0, 0, d}, R}, "E = pi R^2 / d^2", pi * R * R / (d * d),
         "Omega = 2 pi (1 - sqrt(1 - R^2 / d^2))",
         2.0 * pi * (1.0 - std::sqrt(1.0 - R * R / (d * d)))},
        {"disk", DiskLight{{0, 0, d}, down, R}, "E = pi R^2 / (R^2 + d^2)",
         pi * R * R / (R * R + d * d), "Omega = 2 pi (1 - d / sqrt(R^2 + d^2))",
         2.0 * pi * (1.0 - d / std::hypot(R, d))},
        {"sun's disc", DirectionalLight{down, sun}, "E = E_perp", 1.0, "Omega = 2 pi (1 - cos s)",
         2.0 * pi * (1.0 - std::cos(sun))},
        {"white image of a sky", EnvironmentLight{std::make_shared<const EnvironmentMap>(white), 0},
         "E = pi", pi, "Omega = 4 pi", 4.0 * pi},
    };
    for (const Row& row : rows) {
        const Means m = means(row.shape);
        cases.group("light samples", "W/m2");
        cases.relative("mean of L cos / pdf over samples of a " + row.name, row.E_formula, row.E,
                       m.E, 1e-3);
        cases.group("light samples", "sr");
        cases.relative("mean of 1 / pdf over samples of a " + row.name, row.angle_formula,
                       row.solid_angle, m.solid_angle, 1e-3);
        cases.group("light samples", "1");
        cases.absolute("density found again along the samples of a " + row.name,
                       "max |pdf of look / pdf of sample - 1| = 0", 0.0, m.mismatch, 1e-6);
    }
    cases.group("light samples", "sr");
    cases.relative("solid angle of an octant's triangle", "Omega = 4 pi / 8", 0.5 * pi,
                   view({Point3{1, 0, 0}, Point3{0, 1, 0}, Point3{0, 0, 1}}, {}).solid_angle,
                   1e-12);
}

}  // namespace relight
