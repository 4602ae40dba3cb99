#include <cmath>
#include <numbers>

#include "core/check/cases.h"
#include "core/check/meters.h"

// Rectangles, by the view factors F of textbooks (Siegel & Howell, Thermal Radiation Heat
// Transfer): E = pi L F.

namespace relight {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double L = 5.0;
constexpr auto corner_formula =
    "E = L/2 (a/A atan(b/A) + b/B atan(a/B)), A^2 = a^2 + h^2, B^2 = b^2 + h^2";
constexpr auto wall_formula = "E = L/2 (atan(b/c) - c/C atan(b/C)), C^2 = a^2 + c^2";

/// View factor of an element that looks at a parallel rectangle of sides a, b at distance h, above
/// one of its corners.
double corner_factor(double a, double b, double h)
{
    const double A = std::hypot(a, h), B = std::hypot(b, h);
    return (a / A * std::atan(b / A) + b / B * std::atan(a / B)) / (2.0 * pi);
}

/// View factor of an element to a rectangle in a plane at right angles to its own, a high, b wide,
/// at distance c; one lower corner stands straight across.
double wall_factor(double a, double b, double c)
{
    const double X = a / b, Y = c / b;
    const double root = std::hypot(X, Y);
    return (std::atan(1.0 / Y) - Y / root * std::atan(1.0 / root)) / (2.0 * pi);
}

/// Faces down from height h, corners at (x0, y0) and (x1, y1).
Light ceiling(double x0, double y0, double x1, double y1, double h)
{
    return light_of(
        RectLight{{0.5 * (x0 + x1), 0.5 * (y0 + y1), h}, {0, y1 - y0, 0}, {x1 - x0, 0, 0}, false},
        L);
}

void check_shining_faces(Cases& cases)
{
    const Mesh lamp = quads({{0, 0, 1}, {0, 2, 1}, {1, 2, 1}, {1, 0, 1}});  // faces down
    const Light faces = shining(lamp, 2, L);
    const auto readings = read(lamp, {{{0, 0, 0}}}, lit_by({faces}, 4096));
    cases.drawn("shining faces of the mesh are a rectangle", "E = pi L F(rectangle)",
                pi * L * corner_factor(1, 2, 1), readings[0].E);
    cases.group("polygon", "W");
    cases.relative("flux of shining faces", "Phi = pi L A", pi * 2.0,
                   std::get<MeshLight>(faces.shape).table->flux().r, 1e-12);
}

}  // namespace

void check_polygons(Cases& cases)
{
    cases.group("polygon", "W/m2");
    cases.relative("rectangle above its corner", corner_formula, pi * L * corner_factor(1, 2, 1),
                   read_one(ceiling(0, 0, 1, 2, 1), {}).value);
    cases.relative("rectangle above its middle", "E = 4 pi L F(quarter)",
                   4.0 * pi * L * corner_factor(0.5, 1, 0.7),
                   read_one(ceiling(-0.5, -1, 0.5, 1, 0.7), {}).value);
    cases.relative("rectangle aside", "E = pi L (F(3 x 2) - F(1 x 2)) above the corners",
                   pi * L * (corner_factor(3, 2, 1) - corner_factor(1, 2, 1)),
                   read_one(ceiling(1, 0, 3, 2, 1), {}).value);
    cases.relative("endless ceiling", "E -> pi L", pi * L,
                   read_one(ceiling(-1e7, -1e7, 1e7, 1e7, 1), {}).value, 2e-6);
    const Light wall =
        light_of(RectLight{{1.5, 1, 0.75}, {0, 0, 1.5}, {0, 2, 0}, false}, L);  // toward -x
    cases.relative("wall that stands on the receiver's horizon", wall_formula,
                   pi * L * wall_factor(1.5, 2, 1.5), read_one(wall, {}).value);
    const Light sunk = light_of(RectLight{{1.5, 1, 0}, {0, 0, 3}, {0, 2, 0}, false}, L);
    cases.relative("wall that the receiver's horizon cuts in half", wall_formula,
                   pi * L * wall_factor(1.5, 2, 1.5), read_alone(sunk, {}));
    const double r = 500.0, c = std::cos(1.0);
    const Light far = light_of(RectLight{{r * std::sin(1.0), 0, r * c}, {0, 1, 0}, {1, 0, 0}}, L);
    cases.relative("far rectangle", "E -> L A cos(theta_e) cos(theta_i) / r^2", L * c * c / (r * r),
                   read_one(far, {}).value, 1e-5);
    double parts = 0.0;
    for (const double x : {-1.0, 0.0}) {
        for (const double y : {-0.3, 0.7}) {
            parts += read_one(ceiling(x, y, x + 1.0, y + 1.0, 0.6), {}).value;
        }
    }
    cases.relative("four quarters of a rectangle are the whole", "E = sum of the parts' E", parts,
                   read_one(ceiling(-1, -0.3, 1, 1.7, 0.6), {}).value);
    const Light away = light_of(RectLight{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, false}, L);
    cases.exact("rectangle that faces away", "E = 0", 0.0, read_one(away, {}).value);
    const Light both = light_of(RectLight{{0.5, 1, 1}, {1, 0, 0}, {0, 2, 0}, true}, L);
    cases.relative("two-sided rectangle from its back", corner_formula,
                   pi * L * corner_factor(1, 2, 1), read_one(both, {}).value);
    check_shining_faces(cases);
}

}  // namespace relight
