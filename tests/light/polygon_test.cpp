#include "core/light/polygon.h"

#include <array>
#include <span>

#include "core/light/triangle.h"
#include "tests/light/area_checks.h"

namespace relight {
namespace {

using std::numbers::pi;
using test::Numbers;

/// A convex polygon in the plane of u and v: corners on a circle, at ascending angles.
std::vector<Point3> some_polygon(Numbers& random, int corners)
{
    const Frame frame = frame_around(random.direction());
    const Point3 center = random.point(1.0);
    const double radius = random.scale(0.1, 2.0);
    std::vector<Point3> at;
    for (int i = 0; i < corners; ++i) {
        const double phi = 2.0 * pi * (i + random.between(0.05, 0.95)) / corners;
        at.push_back(center + frame.to_world({std::cos(phi), std::sin(phi), 0.0}) * radius);
    }
    return at;
}

/// Twice the area, toward the side that shines.
Vec3 twice_area(std::span<const Point3> at)
{
    Vec3 sum;
    for (std::size_t i = 2; i < at.size(); ++i) { sum += cross(at[i - 1] - at[0], at[i] - at[0]); }
    return sum;
}

TEST(Polygon, FarAwayIsASmallSource)  // L A cos_e cos_i / r^2
{
    for (std::uint64_t item = 0; item < 200; ++item) {
        Numbers random(item);
        const std::vector<Point3> at = some_polygon(random, 3 + static_cast<int>(item % 6));
        Vec3 middle;
        for (const Point3 q : at) { middle += (q - at[0]) / static_cast<double>(at.size()); }
        const Vec3 A = twice_area(at) * 0.5;
        const Dir3 away = normalize(Vec3(normalize(A)) + random.vector(0.8));
        const double r = random.scale(1e4, 1e6);
        const Point3 p = at[0] + middle + Vec3(away) * r;
        const Dir3 n = normalize(-Vec3(away) + random.vector(0.8));
        const double expected = dot(A, away) * dot(n, -away) / (r * r);
        // The middle of the corners is not that of the area: the error is of order size / r.
        EXPECT_NEAR(polygon_irradiance(at, p, n), expected, 10.0 / r * expected);
    }
}

TEST(Polygon, FillsTheHemisphereNearby)  // the infinite plane: pi L
{
    for (std::uint64_t item = 0; item < 50; ++item) {
        Numbers random(item);
        const std::vector<Point3> at = some_polygon(random, 4);
        const Vec3 A = twice_area(at);
        const Point3 inside = at[0] + ((at[1] - at[0]) + (at[2] - at[0]) + (at[3] - at[0])) * 0.25;
        const Dir3 shines = normalize(A);
        const double size = std::sqrt(length(A));
        for (const double h : {1e-6, 1e-9, 1e-12}) {
            const Point3 p = inside + Vec3(shines) * (h * size);
            EXPECT_NEAR(polygon_irradiance(at, p, -shines), pi, 1e-4);
            // Half of a sky over a wall, whatever its edge does.
            EXPECT_NEAR(polygon_irradiance(at, p, frame_around(shines).x), pi / 2, 1e-3);
            EXPECT_EQ(polygon_irradiance(at, p, shines), 0.0);
        }
    }
}

TEST(Polygon, SplittingItChangesNothing)
{
    for (std::uint64_t item = 0; item < 500; ++item) {
        Numbers random(item);
        const std::vector<Point3> at = some_polygon(random, 4 + static_cast<int>(item % 5));
        const Point3 p = random.point(3.0);
        const Dir3 n = random.direction();
        const std::size_t corner = 2 + item % (at.size() - 3);
        const std::vector<Point3> one(at.begin(), at.begin() + static_cast<long>(corner) + 1);
        std::vector<Point3> other(at.begin() + static_cast<long>(corner), at.end());
        other.push_back(at[0]);
        EXPECT_NEAR(polygon_irradiance(one, p, n) + polygon_irradiance(other, p, n),
                    polygon_irradiance(at, p, n), 1e-10);
    }
}

TEST(Polygon, TurningAndMovingChangesNothing)
{
    for (std::uint64_t item = 0; item < 500; ++item) {
        Numbers random(item);
        std::vector<Point3> at = some_polygon(random, 3 + static_cast<int>(item % 6));
        Point3 p = random.point(3.0);
        Dir3 n = random.direction();
        const double E = polygon_irradiance(at, p, n);
        const Frame turn = frame_around(random.direction());
        const Vec3 shift = random.vector(10.0);
        const double scale = random.scale(1e-3, 1e3);
        const auto moved = [&](Point3 q) {
            return Point3{} + turn.to_world(q - Point3{}) * scale + shift * scale;
        };
        for (Point3& q : at) { q = moved(q); }
        p = moved(p);
        n = normalize(turn.to_world(n));
        EXPECT_NEAR(polygon_irradiance(at, p, n), E, 1e-11);  // radiance does not know of scale
    }
}

TEST(Polygon, OnlyWhatStandsAboveTheHorizonCounts)
{
    // A wall that the horizon halves gives what its upper half alone gives.
    const std::array<Point3, 4> wall{{{-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1}}};
    const std::array<Point3, 4> upper{{{-1, 2, 0}, {1, 2, 0}, {1, 2, 1}, {-1, 2, 1}}};
    const Dir3 up = normalize({0, 0, 1});
    EXPECT_GT(polygon_irradiance(wall, {}, up), 0.05);
    EXPECT_NEAR(polygon_irradiance(wall, {}, up), polygon_irradiance(upper, {}, up), 1e-15);
    EXPECT_EQ(polygon_irradiance(upper, {}, -up), 0.0);
}

TEST(Polygon, ARectangleShinesOnOneSideUnlessItHasTwo)
{
    for (std::uint64_t item = 0; item < 200; ++item) {
        Numbers random(item);
        RectLight light = test::some_rect(random);
        light.two_sided = false;
        const Point3 p = random.point(2.0);
        const Dir3 n = random.direction();
        const bool in_front = dot(p - light.center, cross(light.edge_u, light.edge_v)) > 0.0;
        const double front = irradiance(light, p, n);
        std::swap(light.edge_u, light.edge_v);
        const double back = irradiance(light, p, n);
        EXPECT_EQ(in_front ? back : front, 0.0);
        light.two_sided = true;
        EXPECT_NEAR(irradiance(light, p, n), front + back, 1e-14);
        light.two_sided = false;
        EXPECT_EQ(!sample(light, p, random.square()).wi, in_front);
    }
}

TEST(Polygon, SolidAnglesOfACubesFacesFillTheSphere)
{
    for (std::uint64_t item = 0; item < 100; ++item) {
        Numbers random(item);
        const auto inside = [&] { return random.between(-0.5, 0.5) * 0.999999; };
        const Point3 p{inside(), inside(), inside()};
        double sum = 0.0;
        for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
            for (const double side : {-0.5, 0.5}) {
                const Vec3 u = Vec3{axis.y, axis.z, axis.x} * 0.5, v = cross(axis, u);
                const Point3 c = Point3{} + axis * side;
                sum += solid_angle({c - u - v, c + u - v, c + u + v}, p) +
                       solid_angle({c - u - v, c + u + v, c - u + v}, p);
            }
        }
        EXPECT_NEAR(sum, 4.0 * pi, 1e-12);
    }
}

TEST(Polygon, SolidAngleKeepsItsDigitsFarAway)  // A cos / r^2
{
    for (const double r : {1e3, 1e6, 1e12, 1e40}) {
        const std::array<Point3, 3> triangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
        EXPECT_NEAR(solid_angle(triangle, {0, 0, r}) * r * r, 0.5, 1.0 / (r * r) + 1e-14);
    }
}

TEST(Polygon, WhatHasNoAreaOrTouchesIsFinite)
{
    const std::array<Point3, 4> square{{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}};
    const std::vector<Point3> at_places{{-1, -1, 0},  {0, -1, 0},       {0, 0, 0},
                                        {3, 0, 0},    {-1, -1, 1e-300}, {0, -1, 1e-17},
                                        {0, 0, 1e-9}, {1000, -1, 1e-12}};
    for (const Point3 p : at_places) {
        for (const Vec3 n :
             {Vec3{0, 0, 1}, Vec3{0, 0, -1}, Vec3{1, 0, 0}, Vec3{0, -1, 0}, Vec3{1, 1, -1e-9}}) {
            const double E = polygon_irradiance(square, p, normalize(n));
            EXPECT_TRUE(E >= 0.0 && E <= pi) << E;
            if (p.z == 0.0) { EXPECT_EQ(E, 0.0); }
        }
    }
    const std::array<Point3, 4> line{{{-1, -1, 0}, {1, 1, 0}, {2, 2, 0}, {-1, -1, 0}}};
    EXPECT_EQ(polygon_irradiance(line, {0, 0, 1}, normalize({0, 0, -1})), 0.0);
    EXPECT_EQ(polygon_irradiance(std::span(square).first(2), {0, 0, 1}, normalize({0, 0, -1})),
              0.0);
    EXPECT_EQ(polygon_irradiance(square, {0, 0, 1}, Dir3{}), 0.0);
}

}  // namespace
}  // namespace relight
