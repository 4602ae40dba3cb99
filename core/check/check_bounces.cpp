#include <cmath>
#include <numbers>

#include "core/check/cases.h"
#include "core/check/meters.h"

// Light between surfaces.

namespace relight {
namespace {

constexpr double pi = std::numbers::pi;

std::string times(unsigned n)
{
    return std::to_string(n) + (n == 1 ? " bounce" : " bounces");
}

/// 1 + q + .. + q^n
double series(double q, unsigned n)
{
    return (1.0 - std::pow(q, n + 1)) / (1.0 - q);
}

Mesh box()
{
    return quads({{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0},    // below
                  {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1},    // above
                  {0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1},    // y = 0
                  {0, 1, 0}, {0, 1, 1}, {1, 1, 1}, {1, 1, 0},    // y = 1
                  {0, 0, 0}, {0, 0, 1}, {0, 1, 1}, {0, 1, 0},    // x = 0
                  {1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {1, 0, 1}});  // x = 1
}

void check_furnace(Cases& cases)
{
    cases.group("furnace", "W/m2");
    const Mesh room = inside_out(box());
    const double Le = 2.0, rho = 0.5;
    const Meters meters(room, {{{0.5, 0.5, 0.5}}, {{0.9, 0.2, 0.7}, {1, 2, -3}}});
    const char* where[] = {"in its middle", "near a corner"};
    Scene scene = lit_by({shining(room, room.faces.count(), Le)}, 16384);
    scene.materials = {Lambert{Rgb::grey(rho)}};
    for (const unsigned n : {0U, 1U, 4U}) {
        scene.transport.bounces = n;
        const auto readings = read_column(meters, scene);
        for (std::size_t i = 0; i < meters.count; ++i) {
            cases.drawn("room of shining walls after " + times(n) + ", " + where[i],
                        "E = pi Le (1 + rho + .. + rho^n)", pi * Le * series(rho, n),
                        readings[i].E);
        }
    }
}

void check_integrating_sphere(Cases& cases)
{
    cases.group("integrating sphere", "W/m2");
    const double R = 2.0, rho = 0.8, Phi = 30.0;
    Mesh sphere = inside_out(ball(5));
    for (Point3& p : sphere.positions) { p = Point3{} + (p - Point3{}) * R; }
    std::vector<Meter> places;
    for (const Vec3 out : {Vec3{0.36, 0.48, -0.8}, Vec3{-0.6, 0.64, 0.48}}) {
        // On the round wall, stepped inside the flat faces that stand for it.
        places.push_back({Point3{} + out * (R * (1.0 - 2e-3)), -out});
    }
    const Meters meters(sphere, places);
    Scene scene = lit_by({light_of(PointLight{{0.2, -0.1, 0.3}, {}}, Phi / (4.0 * pi))}, 16384);
    scene.materials = {Lambert{Rgb::grey(rho)}};
    for (const unsigned n : {1U, 3U, 12U}) {
        scene.transport.bounces = n;
        const auto readings = read_column(meters, scene);
        for (std::size_t i = 0; i < places.size(); ++i) {
            cases.relative("light of " + times(n) + " in a sphere, place " + std::to_string(i + 1) +
                               ", lamp off its middle",
                           "E = Phi / (4 pi R^2) (rho + .. + rho^n)",
                           Phi / (4.0 * pi * R * R) * rho * series(rho, n - 1), readings[i].bounced,
                           0.01);
        }
    }
}

void check_open_bounces(Cases& cases)
{
    cases.group("bounces", "W/m2");
    const double wide = 1e4, rho = 0.6, E_perp = 3.0;
    const Mesh ground =
        quads({{-wide, -wide, 0}, {wide, -wide, 0}, {wide, wide, 0}, {-wide, wide, 0}});
    Scene scene = lit_by({light_of(DirectionalLight{normalize({0.6, 0, -0.8}), 0.0}, E_perp)}, 256);
    scene.materials = {Lambert{Rgb::grey(rho)}};
    scene.transport.bounces = 1;
    const auto above = read(ground, {{{0, 0, 1}, {0, 0, -1}}}, scene);
    cases.drawn("sunlit ground shines up", "E = rho E_perp cos", rho * E_perp * 0.8, above[0].E,
                1e-5);
    // Two endless plates, the lower one shining: the upper gets pi Le, and after two bounces more
    // rho^2 of it again.
    const Mesh plates = joined(
        ground, quads({{-wide, -wide, 1}, {-wide, wide, 1}, {wide, wide, 1}, {wide, -wide, 1}}));
    scene.lights = {shining(plates, 2, 1.0)};
    scene.transport.samples = 16384;
    scene.transport.bounces = 2;
    const auto between =
        read_column({plates, {{{0, 0, 0.999}, {0, 0, -1}}, {{0, 0, 0.001}}}}, scene);
    cases.drawn("plate across from a shining one, two bounces", "E = pi Le (1 + rho^2)",
                pi * (1.0 + rho * rho), between[0].E, 1e-5);
    cases.drawn("shining plate's own light handed back", "E = pi Le rho", pi * rho, between[1].E,
                1e-5);
}

}  // namespace

void check_bounces(Cases& cases)
{
    check_furnace(cases);
    check_integrating_sphere(cases);
    check_open_bounces(cases);
}

}  // namespace relight
