// What floats cannot tell: distances far below the size of the model, where doubles decide.
#include "core/trace/meeting.h"
#include "tests/trace/model.h"

namespace relight {
namespace {

using namespace test;

/// A wall through the origin, 4 km square, its normal along `frame.n`.
Mesh wall(const Frame& frame, int cells)
{
    return test::moved(test::grid(cells), frame, 2000.0, {});
}

TEST(NearHit, AReceiverOnAWallOfTwoKilometresStepsOffByMicrometresAndIsNotInItsShadow)
{
    Numbers numbers;
    for (const Frame& frame : {test::upright(), frame_around(normalize({0.3, -0.5, 0.7}))}) {
        for (const int cells : {1, 50}) {
            const Model model(wall(frame, cells));
            const Clearance clear = model.bvh.clearance(0.0);
            EXPECT_LT(clear.offset, 1e-5);
            for (int k = 0; k < 20000; ++k) {
                const Vec3 place =
                    frame.to_world({numbers.in(-1900, 1900), numbers.in(-1900, 1900), 0.0});
                const Dir3 wi = numbers.direction();
                const Point3 origin = Point3{} + place + Vec3(frame.n) * clear.offset;
                const double cos_i = dot(wi, frame.n);
                const bool blocked = model.blocked({origin, wi, clear.from, far});
                if (cos_i > 0.0) { ASSERT_FALSE(blocked) << cells << " cells, cosine " << cos_i; }
                // Looking into the wall, all but along it, the wall is there.
                if (cos_i < -0.1) { ASSERT_TRUE(blocked) << cells << " cells, cosine " << cos_i; }
            }
        }
    }
}

TEST(NearHit, AWallInAGapOfATenMillionthOfTheSizeStillShadows)
{
    Numbers numbers;
    const Frame frame = frame_around(normalize({0.3, -0.5, 0.7}));
    const double gap = 1e-7 * 4000.0;
    const Model model(test::joined(
        wall(frame, 1), test::moved(wall(frame, 1), test::upright(), 1.0, Vec3(frame.n) * gap)));
    const double offset = model.bvh.clearance(0.0).offset;
    for (int k = 0; k < 20000; ++k) {
        const Vec3 place = frame.to_world({numbers.in(-1900, 1900), numbers.in(-1900, 1900), 0.0});
        const Dir3 wi = numbers.direction();
        if (dot(wi, frame.n) < 0.05) { continue; }
        EXPECT_TRUE(model.blocked({Point3{} + place + Vec3(frame.n) * offset, wi, 0.0, far}));
        EXPECT_TRUE(
            model.blocked({Point3{} + place + Vec3(frame.n) * (gap - offset), -wi, 0.0, far}));
        // Above the second wall there is nothing; 40 micrometres short of it neither.
        EXPECT_FALSE(
            model.blocked({Point3{} + place + Vec3(frame.n) * (gap + offset), wi, 0.0, far}));
        const double reach = (0.9 * gap - offset) / dot(wi, frame.n);
        EXPECT_FALSE(model.blocked({Point3{} + place + Vec3(frame.n) * offset, wi, 0.0, reach}));
    }
}

TEST(NearHit, AWallOfKilometresAMillimetreAwayHidesWhatLiesBehindItAndNothingElse)
{
    Numbers numbers;
    for (const Frame& frame : {test::upright(), frame_around(normalize({0.3, -0.5, 0.7}))}) {
        const Model model(wall(frame, 1));
        for (const double d : {1e-4, 1e-3, 1e-2, 1.0}) {
            for (int k = 0; k < 5000; ++k) {
                const Vec3 wi = numbers.direction();
                const Vec3 place{numbers.in(-1900, 1900), numbers.in(-1900, 1900), d};
                const Vec3 meets = place + wi * (d / -wi.z);
                const double beside = std::max(std::abs(meets.x), std::abs(meets.y)) - 2000.0;
                if (std::abs(wi.z) < 0.05 || std::abs(beside) < 0.01) { continue; }
                ASSERT_EQ(model.blocked({Point3{} + frame.to_world(place),
                                         normalize(frame.to_world(wi)), 0.0, far}),
                          wi.z < 0.0 && beside < 0.0)
                    << d;
            }
        }
    }
}

TEST(NearHit, ACornerOfABoxAMicrometreAwayHidesOnlyWhatItCovers)
{
    // Floats put the origin to either side of any of three faces, and the ray beside their edges.
    Numbers numbers;
    const Frame frame = frame_around(normalize({0.3, -0.5, 0.7}));
    const Model model(test::moved(test::box({-900, -900, -900}, {900, 900, 900}), frame, 1.0, {}));
    const double gap = model.bvh.clearance(0.0).offset;
    for (int k = 0; k < 20000; ++k) {
        const double along =
            k % 2 == 0 ? 0.0 : numbers.in(0.0, 800.0);  // an edge, every other time
        const Vec3 place{900.0 + gap, 900.0 + gap, 900.0 + gap - along};
        const Vec3 wi = numbers.direction();
        // Where the ray is between each pair of opposite faces at once, it is in the box.
        double enters = 0.0;
        double leaves = far;
        for (const auto& [from, d] : {std::pair{place.x, wi.x}, {place.y, wi.y}, {place.z, wi.z}}) {
            enters = std::max(enters, std::min((-900 - from) / d, (900 - from) / d));
            leaves = std::min(leaves, std::max((-900 - from) / d, (900 - from) / d));
        }
        const bool blocked = model.blocked(
            {Point3{} + frame.to_world(place), normalize(frame.to_world(wi)), 0.0, far});
        if (enters >= leaves) { ASSERT_FALSE(blocked) << wi.x << " " << wi.y << " " << wi.z; }
        if (leaves - enters > 0.1) { ASSERT_TRUE(blocked) << wi.x << " " << wi.y << " " << wi.z; }
    }
}

TEST(NearHit, ALampOnASurfaceIsNotHiddenByIt)  // a ray's far end is as exact as its near one
{
    Numbers numbers;
    const Frame frame = frame_around(normalize({0.3, -0.5, 0.7}));
    const Model model(wall(frame, 1));
    const double clearance = model.bvh.clearance(0.0).offset;
    for (int k = 0; k < 5000; ++k) {
        const Point3 lamp =
            Point3{} + frame.to_world({numbers.in(-900, 900), numbers.in(-900, 900), 0.0});
        const Dir3 from_lamp = numbers.direction();
        const double distance = numbers.in(0.001, 500.0);
        const Point3 origin = lamp + Vec3(from_lamp) * distance;
        EXPECT_FALSE(model.blocked({origin, -from_lamp, 0.0, distance - clearance}));
        if (std::abs(dot(from_lamp, frame.n)) < 0.1) { continue; }
        EXPECT_TRUE(model.blocked({origin, -from_lamp, 0.0, distance + 20 * clearance}));
    }
}

TEST(NearHit, TheMeetingOfALineAndATriangleIsWhereItWasMade)
{
    Numbers numbers;
    const auto vector = [&] {
        return Vec3{numbers.in(-1, 1), numbers.in(-1, 1), numbers.in(-1, 1)};
    };
    for (int k = 0; k < 10000; ++k) {
        const Vec3 a = vector(), b = vector(), c = vector();
        const double u = numbers.in(-0.5, 1.5), v = numbers.in(-0.5, 1.5);
        const Vec3 p = a * (1 - u - v) + b * u + c * v;
        if (std::abs(dot(normalize(cross(b - a, c - a)), normalize(p))) < 1e-3) { continue; }
        const double edge = std::min({u, v, 1 - u - v});
        if (std::abs(edge) < 1e-9) { continue; }
        const auto met = meet_triangle(normalize(p), a, b, c);
        ASSERT_TRUE(met);
        EXPECT_EQ(met->inside, edge > 0.0);
        if (!met->inside) { continue; }
        EXPECT_NEAR(met->t, length(p), 1e-9);
        EXPECT_NEAR(met->u, u, 1e-9);
        EXPECT_NEAR(met->v, v, 1e-9);
    }
    EXPECT_FALSE(meet_triangle(up, {1, 0, 1}, {2, 0, 1}, {1, 0, 5}));  // in its plane
    EXPECT_FALSE(meet_triangle(up, {1, 0, 1}, {1, 0, 1}, {1, 0, 1}));  // no area
}

}  // namespace
}  // namespace relight
