#include <cmath>
#include <numbers>

#include "core/check/cases.h"
#include "core/check/meters.h"

// What holds of all lights together: they add up, grow with their power, and know no scale.

namespace relight {
namespace {

std::vector<Light> lamps(double k)
{
    return {light_of(PointLight{{k, 0, 2 * k}, {}}, 3.0 * k * k),  // I grows with the square
            light_of(RectLight{{-k, 0, 2 * k}, {0, k, 0}, {k, 0, 0}, false}, 2.0),
            light_of(SphereLight{{0, k, 1.5 * k}, 0.3 * k}, 1.0),
            light_of(DirectionalLight{normalize({0.3, 0.2, -1}), 0.01}, 0.5)};
}

/// A roof over part of a floor, k times as large, moved by `shift`.
Mesh shed(double k, Vec3 shift = {})
{
    Mesh mesh = quads({{-4, -4, 0},
                       {4, -4, 0},
                       {4, 4, 0},
                       {-4, 4, 0},
                       {-3, -4, 1},
                       {0.1, -4, 1},
                       {0.1, 4, 1},
                       {-3, 4, 1}});
    for (Point3& p : mesh.positions) { p = Point3{} + (p - Point3{}) * k + shift; }
    return mesh;
}

void check_additivity(Cases& cases)
{
    cases.group("superposition", "W/m2");
    const Meter meter{{0.2, 0.1, 0}};
    Scene scene = lit_by(lamps(1.0));
    const Reading all = read(shed(1.0), {meter}, scene)[0];
    double parts = 0.0;
    for (std::size_t i = 0; i < scene.lights.size(); ++i) {
        Scene alone = scene;
        for (std::size_t j = 0; j < scene.lights.size(); ++j) { alone.lights[j].enabled = i == j; }
        parts += read(shed(1.0), {meter}, alone)[0].E.value;
    }
    cases.relative("four lights together", "E = sum of E with each alone", parts, all.E.value);
    double listed = 0.0;
    for (const double E : all.per_light) { listed += E; }
    cases.relative("per-light values of one answer", "E = sum of the lights' E", all.E.value,
                   listed);
    for (Light& light : scene.lights) { light.power = light.power * 2.0; }
    cases.relative("twice the power, shadows and penumbrae included", "E = 2 E before",
                   2.0 * all.E.value, read(shed(1.0), {meter}, scene)[0].E.value);
}

void check_scale(Cases& cases)
{
    cases.group("scale", "W/m2");
    const Meter meter{{0.2, 0.1, 0}};
    const double E = read(shed(1.0), {meter}, lit_by(lamps(1.0)))[0].E.value;
    for (const double k : {1e-3, 1e3}) {
        Scene scene = lit_by(lamps(k));
        scene.transport.shadows = false;  // which points are drawn depends on where they are
        Scene unscaled = lit_by(lamps(1.0));
        unscaled.transport.shadows = false;
        const std::string name = k < 1.0 ? "a thousandth" : "a thousand times";
        cases.relative("world of " + name + " the size, I as its square",
                       "E(k lengths, k^2 I) = E, radiance unchanged",
                       read(shed(1.0), {meter}, unscaled)[0].E.value,
                       read(shed(k), {{{0.2 * k, 0.1 * k, 0}}}, scene)[0].E.value);
    }
    Scene centimetres = lit_by({light_of(PointLight{{0, 0, 200}, {}}, 3.0)});
    centimetres.length_unit_m = 0.01;
    cases.relative("file in centimetres", "E = I / (2 m)^2", 0.75,
                   read(floor_with_block(), {Meter{}}, centimetres)[0].E.value);
    const Vec3 shift{1e6, -2e6, 5e5};
    std::vector<Light> there = lamps(1.0);
    std::get<PointLight>(there[0].shape).position = Point3{1, 0, 2} + shift;
    there.resize(1);
    std::vector<Light> here = lamps(1.0);
    here.resize(1);
    cases.relative("world moved by two thousand kilometres", "E = E before",
                   read(shed(1.0), {meter}, lit_by(here))[0].E.value,
                   read(shed(1.0, shift), {{meter.p + shift, meter.n}}, lit_by(there))[0].E.value);
    cases.relative("doubling a distance", "E(2 d) = E(d) / 4",
                   0.25 * read_one(light_of(PointLight{{0, 0, 2}, {}}), {}).value,
                   read_one(light_of(PointLight{{0, 0, 4}, {}}), {}).value);
    cases.relative("same world again", "E = E before", E,
                   read(shed(1.0), {meter}, lit_by(lamps(1.0)))[0].E.value, 0.0);
}

}  // namespace

void check_laws(Cases& cases)
{
    check_additivity(cases);
    check_scale(cases);
}

}  // namespace relight
