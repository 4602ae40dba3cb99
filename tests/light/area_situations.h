#pragma once

#include <array>
#include <functional>
#include <string>

#include "core/light/triangle.h"
#include "tests/light/area_checks.h"

/// Every sampler of an area light, seen from ordinary, near, touching and far places.
namespace relight::test {

/// One light seen from one place, as draws and as looks.
struct Situation {
    std::string name;
    std::function<LightSample(Numbers&)> draw;
    std::function<LightSample(Dir3)> at;
};

inline Situation of(std::string name, const LightShape& shape, Point3 p)
{
    return {std::move(name),
            [=](Numbers& random) {
                const Sample2 s = random.square();
                return sample(shape, p, s, random.next());
            },
            [=](Dir3 wi) { return look(shape, p, wi); }};
}
inline Situation of(std::string name, const std::array<Point3, 3>& triangle, Point3 p)
{
    return {std::move(name),
            [=](Numbers& random) { return sample_triangle(triangle, p, random.square()); },
            [=](Dir3 wi) { return look_at_triangle(triangle, p, wi); }};
}

/// Flat lights are uniform in solid angle: how they are drawn, and what they consist of.
struct Flat {
    Situation seen;
    std::vector<std::array<Point3, 3>> triangles;
    Point3 p;
};

/// Ordinary, near, touching and far.
inline std::vector<Flat> flat_lights()
{
    const std::array<Point3, 3> triangle{{{-1, -0.5, 0}, {1.5, -0.4, 0}, {0.2, 1, 0}}};
    const std::array<Point3, 3> sliver{{{-1, 0, 0}, {1, 0, 0}, {0.3, 1e-6, 0}}};
    std::vector<Flat> lights;
    const auto add = [&](std::string name, const std::array<Point3, 3>& t, Point3 p) {
        lights.push_back({of(std::move(name), t, p), {t}, p});
    };
    add("triangle", triangle, {0.3, 0.2, 0.7});
    add("triangle from behind", triangle, {0.3, 0.2, -0.7});
    add("triangle aside", triangle, {2, 1, 0.3});
    add("triangle grazed", triangle, {2, 1, 1e-5});
    add("triangle near", triangle, {0.3, 0.2, 1e-3});
    add("triangle very near", triangle, {0.3, 0.2, 1e-7});
    add("triangle touched", triangle, {0.3, 0.2, 1e-11});
    add("triangle near its edge", triangle, {0.25, -0.45, 1e-6});
    add("triangle near its corner", triangle, {-1, -0.5, 1e-6});
    add("triangle far", triangle, {30, 20, 70});
    add("triangle very far", triangle, {3000, 2000, 7000});
    add("triangle very far and grazed", triangle, {3e4, 2e4, 7});
    add("sliver", sliver, {0.1, 0.2, 0.5});
    add("sliver near", sliver, {0.1, 1e-4, 1e-4});

    RectLight rect{{0.1, 0, 0}, {2, 0.3, 0}, {0, 1, 0}};
    const Point3 corner = rect.center - rect.edge_u * 0.5 - rect.edge_v * 0.5;
    const Point3 opposite = rect.center + rect.edge_u * 0.5 + rect.edge_v * 0.5;
    const auto add_rect = [&](std::string name, Point3 p) {
        lights.push_back(
            {of(std::move(name), rect, p),
             {{corner, corner + rect.edge_u, opposite}, {corner, opposite, corner + rect.edge_v}},
             p});
    };
    add_rect("rect", {0.3, 0.2, 0.7});
    add_rect("rect near", {0.9, 0.2, 1e-3});
    add_rect("rect near its corner", {-0.9, -0.65, 1e-4});
    add_rect("rect far", {3, 200, 70});
    rect.two_sided = true;
    add_rect("rect of two sides", {0.3, 0.2, -0.7});
    return lights;
}

inline std::vector<Situation> round_lights()
{
    const DiskLight disk{{}, normalize({0, 0, 1}), 1.0};
    const DiskLight leaning{{0.3, 0.2, -0.1}, normalize({1, 2, 3}), 0.7};
    const SphereLight sphere{{0.2, -0.1, 0.3}, 0.5};
    return {
        of("disk on its axis", disk, {0, 0, 0.5}),
        of("disk", disk, {0.4, 0.3, 0.2}),
        of("disk aside", leaning, {2, 1, 0.5}),
        of("disk near", disk, {0.4, 0.3, 1e-3}),
        of("disk touched", disk, {0.4, 0.3, 1e-12}),
        of("disk near its rim", disk, {0.6, 0.8, 1e-3}),
        of("disk grazed", disk, {1.5, 0.8, 0.1}),
        of("disk far", leaning, {30, 20, 10}),
        of("disk very far", leaning, {3e5, 2e5, 1e5}),
        of("sphere", sphere, {1, 1, 1}),
        of("sphere touched", sphere, {0.2, -0.1, 0.8000001}),
        of("sphere far", sphere, {100, 20, 30}),
        of("sphere very far", sphere, {1e6, 2e5, 3e5}),
        of("sun", DirectionalLight{normalize({1, -2, 1}), 0.004651}, {}),
        of("half the sky", DirectionalLight{normalize({1, -2, 1}), 0.5 * std::numbers::pi}, {})};
}

inline std::vector<Situation> situations()
{
    std::vector<Situation> all = round_lights();
    for (const Flat& light : flat_lights()) { all.push_back(light.seen); }
    return all;
}

}  // namespace relight::test
