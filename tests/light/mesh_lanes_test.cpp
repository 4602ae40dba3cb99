// Shining faces drawn in vectors, and found by a tree, beside the scalar functions they stand for.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "core/base/random.h"
#include "core/light/emitter_tree.h"
#include "core/light/mesh_light.h"
#include "core/light/triangle.h"

namespace relight {
namespace {

struct Number {
    std::uint64_t item, next = 0;
    double between(double a, double b) { return a + (b - a) * uniform(29, item, next++, 0); }
    Vec3 vector(double size)
    {
        return {between(-size, size), between(-size, size), between(-size, size)};
    }
};

/// Triangles of sizes from a thousandth to 1 in a cube of 2, each of a colour of its own.
std::vector<Emitter> motley_faces(std::uint32_t count)
{
    std::vector<Emitter> emitters;
    for (std::uint32_t e = 0; e < count; ++e) {
        Number number{e};
        const double size = std::exp2(number.between(-10.0, 0.0));
        const Point3 a = Point3{} + number.vector(1.0);
        emitters.push_back({{a, a + number.vector(size), a + number.vector(size)},
                            7 * e,
                            Rgb{1.0 + e, number.between(0.0, 2.0), 0.5}});
    }
    return emitters;
}

/// Places all about: among the faces, at their very corners, in their planes, next to them, far.
std::vector<Point3> motley_places(const std::vector<Emitter>& emitters, std::size_t count)
{
    std::vector<Point3> places;
    for (std::size_t i = 0; i < count; ++i) {
        Number number{10'000 + i};
        const auto& [a, b, c] = emitters[i % emitters.size()].corners;
        const Vec3 normal = cross(b - a, c - a);
        const Point3 within = a + (b - a) * 0.3 + (c - a) * 0.4;
        switch (i % 6) {
            case 0:
                places.push_back(a);
                break;
            case 1:
                places.push_back(a + (b - a) * 3.0);
                break;
            case 2:
                places.push_back(within - normal * 1e-7);
                break;
            case 3:
                places.push_back(within - normal * number.between(-0.1, 1.0));
                break;
            case 4:
                places.push_back(Point3{} + number.vector(1e5));
                break;
            default:
                places.push_back(Point3{} + number.vector(2.0));
        }
    }
    return places;
}

TEST(MeshLanes, AreTheTablesSamples)
{
    const auto emitters = motley_faces(40);
    const EmitterTable table(emitters);
    const auto places = motley_places(emitters, 20'000);
    MeshLanes lanes;
    std::size_t seen = 0;
    for (std::size_t first = 0; first < places.size(); first += 500) {
        for (std::size_t i = 0; i < 500; ++i) {
            Number number{50'000 + first + i};
            lanes.u[i] = number.between(0.0, 1.0);
            lanes.v[i] = number.between(0.0, 1.0);
            lanes.pick[i] = i == 0   ? 0.0
                            : i == 1 ? std::nextafter(1.0, 0.0)
                                     : number.between(0.0, 1.0);
            const Point3 p = places[first + i];
            lanes.px[i] = p.x, lanes.py[i] = p.y, lanes.pz[i] = p.z;
        }
        sample(table, 500, lanes);
        for (std::size_t i = 0; i < 500; ++i) {
            const Point3 p = places[first + i];
            const LightSample there = table.sample(p, {lanes.u[i], lanes.v[i]}, lanes.pick[i]);
            if (!there.wi) {
                ASSERT_EQ(lanes.seen.pdf[i], 0.0);
                continue;
            }
            ++seen;
            // As far as the solid angle of what is thin has digits, in another order of sums.
            ASSERT_NEAR(lanes.seen.pdf[i], there.pdf, 1e-7 * there.pdf);
            ASSERT_LE(length(Vec3{lanes.x[i], lanes.y[i], lanes.z[i]} - there.wi), 1e-7);
            ASSERT_NEAR(lanes.distance[i], there.distance, 1e-6 * there.distance);
            ASSERT_EQ(lanes.seen.L(i), there.L);
        }
    }
    EXPECT_GT(seen, places.size() / 5);
}

TEST(EmitterBounds, AreBelowOnlyWhereNoFaceRisesAboveThePlane)
{
    std::size_t below = 0;
    for (std::uint64_t item = 0; item < 3'000; ++item) {
        const auto emitters = motley_faces(1 + static_cast<std::uint32_t>(item % 5));
        const EmitterTable table(emitters);
        Number number{item};
        const Point3 p = Point3{} + number.vector(item % 3 == 0 ? 1.0 : 8.0);
        const Dir3 n = item % 7 == 0 ? normalize({0, -1, 0}) : normalize(number.vector(1.0));
        if (!table.bounds().are_below(p, n)) { continue; }
        ++below;
        for (const Emitter& emitter : emitters) {
            for (const Point3 corner : emitter.corners) { ASSERT_LE(dot(n, corner - p), 0.0); }
        }
    }
    EXPECT_GT(below, 500U);
    const EmitterTable one({{{Point3{0, 1, 0}, {0, 1, 1}, {1, 1, 0}}, 0, Rgb::grey(1.0)}});
    EXPECT_TRUE(one.bounds().are_below({0, 2, 0}, {0, 1, 0}));
    EXPECT_FALSE(one.bounds().are_below({0, 0.999, 0}, {0, 1, 0}));
}

TEST(MeshLanes, OfNoFacesShowNothing)
{
    const EmitterTable table({});
    MeshLanes lanes{};
    lanes.seen.pdf[0] = lanes.seen.pdf[1] = 3.0;
    sample(table, 2, lanes);
    EXPECT_EQ(lanes.seen.pdf[0], 0.0);
    EXPECT_EQ(lanes.seen.pdf[1], 0.0);
    EXPECT_FALSE(table.look_along({}, {}, normalize({0, 1, 0})).wi);
}

/// The first that the ray meets, one after the other.
std::optional<std::uint32_t> nearest_of_all(const std::vector<Emitter>& emitters, Point3 origin,
                                            Dir3 wi)
{
    double least = std::numeric_limits<double>::infinity();
    std::optional<std::uint32_t> found;
    for (std::uint32_t e = 0; e < emitters.size(); ++e) {
        const LightSample there = look_at_triangle(emitters[e].corners, origin, wi);
        if (there.wi && there.distance < least) {
            least = there.distance;
            found = e;
        }
    }
    return found;
}

TEST(EmitterTree, FindsTheFirstOfAllThatARayMeets)
{
    for (const std::uint32_t count : {1U, 7U, 8U, 9U, 65U, 700U}) {
        const auto emitters = motley_faces(count);
        const EmitterTree tree(emitters);
        std::size_t met = 0;
        for (std::uint64_t item = 0; item < 3'000; ++item) {
            Number number{item};
            const Point3 origin = Point3{} + number.vector(item % 2 == 0 ? 1.0 : 4.0);
            const Emitter& aimed = emitters[item % count];
            const Point3 at = aimed.corners[0] + (aimed.corners[1] - aimed.corners[0]) * 0.25 +
                              (aimed.corners[2] - aimed.corners[0]) * 0.25;
            const Dir3 wi = item % 4 == 0 ? normalize(number.vector(1.0)) : normalize(at - origin);
            const auto expected = nearest_of_all(emitters, origin, wi);
            ASSERT_EQ(tree.nearest(origin, wi), expected) << item << " of " << count;
            met += expected ? 1 : 0;
        }
        EXPECT_GT(met, 2'000U);
    }
}

TEST(EmitterTree, RaysAlongTheAxesMeetFlatFacesBetweenThem)
{
    std::vector<Emitter> floor;  // 20 by 20 squares of the plane y = 0, whose boxes are flat
    for (int i = 0; i < 20; ++i) {
        for (int j = 0; j < 20; ++j) {
            const Point3 a{1.0 * i, 0, 1.0 * j}, b{i + 1.0, 0, 1.0 * j}, c{i + 1.0, 0, j + 1.0},
                d{1.0 * i, 0, j + 1.0};
            floor.push_back({{a, b, c}, 0, Rgb::grey(1.0)});
            floor.push_back({{a, c, d}, 1, Rgb::grey(1.0)});
        }
    }
    const EmitterTree tree(floor);
    for (const double sign : {1.0, -1.0}) {
        for (int i = 1; i < 60; ++i) {
            const Point3 on_edges{i / 3.0, sign, 7.0};  // and at corners
            EXPECT_TRUE(tree.nearest(on_edges, normalize({0, -sign, 0}))) << i;
            EXPECT_FALSE(tree.nearest(on_edges, normalize({0, sign, 0})));
            EXPECT_FALSE(tree.nearest({i / 3.0, 0.1 * sign, -1.0}, normalize({0, 0, 1})));
        }
    }
}

TEST(EmitterTree, OfFacesFiledTwiceTheFirstIsFound)
{
    std::vector<Emitter> twice = motley_faces(30);
    for (const Emitter& e : motley_faces(30)) { twice.insert(twice.begin(), e); }
    const EmitterTree tree(twice);
    for (std::uint32_t e = 0; e < 30; ++e) {
        const auto& [a, b, c] = twice[e].corners;
        const Point3 within = a + (b - a) * 0.3 + (c - a) * 0.3;
        const Dir3 away = normalize(cross(b - a, c - a));
        const auto found = tree.nearest(within + Vec3(away) * 1e-9, -away);
        ASSERT_TRUE(found);
        EXPECT_LT(*found, 30U);
    }
}

TEST(MeshLight, ALookAlongARayIsTheLookAtTheFaceItMeetsFirst)
{
    const auto emitters = motley_faces(400);
    const EmitterTable table(emitters);
    std::size_t lit = 0;
    for (std::uint64_t item = 0; item < 2'000; ++item) {
        Number number{item};
        const Point3 p = Point3{} + number.vector(1.5);
        const Dir3 wi = normalize(number.vector(1.0));
        const LightSample there = table.look_along(p, p, wi);
        const auto first = nearest_of_all(emitters, p, wi);
        const LightSample expected =
            first ? table.look(emitters[*first].primitive, p, wi) : LightSample{};
        ASSERT_EQ(there.wi, expected.wi);
        ASSERT_EQ(there.L, expected.L);
        ASSERT_EQ(there.pdf, expected.pdf);
        lit += there.wi ? 1 : 0;
    }
    EXPECT_GT(lit, 200U);
}

}  // namespace
}  // namespace relight
