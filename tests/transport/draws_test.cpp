// Vectors of samples beside the scalar functions that they stand for.
#include "core/transport/draws.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "core/base/random.h"
#include "tests/scenes.h"

namespace relight {
namespace {

struct Number {
    std::uint64_t item, next = 0;
    double between(double a, double b) { return a + (b - a) * uniform(17, item, next++, 0); }
    Vec3 vector(double size)
    {
        return {between(-size, size), between(-size, size), between(-size, size)};
    }
};

Receiver receiver_at(Point3 p, Dir3 n)
{
    return {p, p, frame_around(n), n, {1e-4, 0.0}};
}

/// Rays of `view` against one sample after the other: what each brings to the bit; where it goes
/// within 16 roundings, of the coordinates too, which the scalar function adds before it subtracts.
template <class View>
void expect_the_scalar_rays(const View& view, const Receiver& receiver, const Stage& stage,
                            const TransportOptions& options, std::uint64_t key)
{
    const Sequence sequence(1, key, 2, 0);
    for (const Lanes& lanes : lanes_of(7, 1, 12)) {
        const Drawn drawn = draw(view, receiver, *stage.bvh, options, sequence, 3, lanes);
        for (unsigned i = 0; i < lanes.count; ++i) {
            const Sample2 s = sequence.replicate(lanes.replicate[i]).at(lanes.point[i], 3);
            LightSample there;
            if (view.is_seen()) { there = view.sample_direction(s); }
            const double cos_n = dot(receiver.frame.n, there.wi);
            const double cos_i = options.two_sided ? std::abs(cos_n) : std::max(0.0, cos_n);
            ASSERT_EQ(drawn.E[i], cos_i > 0.0 ? there.L.r * cos_i / there.pdf : 0.0);
            if (!(drawn.E[i] > 0.0)) { continue; }
            const ShadowRay ray = drawn.ray(receiver, i);
            const ShadowRay expected =
                shadow_ray(*stage.bvh, receiver, there.wi, there.distance, options);
            ASSERT_EQ(ray.origin, expected.origin);
            ASSERT_EQ(ray.from, expected.from);
            const double rounding = 4e-15 * length(receiver.p - Point3{});
            ASSERT_LE(length(Vec3(ray.direction) - expected.direction),
                      4e-15 + (expected.distance > 0.0 ? rounding / expected.distance : 0.0));
            if (std::isinf(expected.distance)) {
                ASSERT_EQ(ray.distance, expected.distance);
            } else {
                ASSERT_NEAR(ray.distance, expected.distance, 4e-15 * expected.distance + rounding);
            }
        }
    }
}

TEST(Draws, EveryLaneIsWhatTheScalarFunctionsGive)
{
    const Stage stage = test::staged(test::icosphere(2));
    for (std::uint64_t item = 0; item < 300; ++item) {
        Number number{item};
        TransportOptions options;
        options.two_sided = item % 3 == 0;
        if (item % 4 == 0) { options.max_distance = number.between(0.0, 3.0); }
        const Point3 p = Point3{} + number.vector(2.0);
        const Receiver receiver = receiver_at(p, normalize(number.vector(1.0)));
        // Some lights stand as near as the step off the surface, some fill the sky, some are far.
        const double size = std::exp2(number.between(-30.0, 3.0));
        const Point3 place = p + number.vector(1.0) * std::exp2(number.between(-16.0, 6.0));
        const Dir3 facing = normalize(p - place + number.vector(0.3));
        const Frame frame = frame_around(facing);
        const RectLight rect{place, Vec3(frame.x) * size,
                             Vec3(frame.y) * (size * number.between(0.01, 1.0)), false};
        expect_the_scalar_rays(DiskView({place, facing, size}, p), receiver, stage, options, item);
        expect_the_scalar_rays(SphereView({place, size}, p), receiver, stage, options, item);
        expect_the_scalar_rays(SunView({facing, number.between(1e-6, 1.5)}), receiver, stage,
                               options, item);
        expect_the_scalar_rays(CosineView(receiver.frame, options.two_sided), receiver, stage,
                               options, item);
        const RectView seen(rect, p);
        if (!seen.by_area()) {
            expect_the_scalar_rays(seen, receiver, stage, options, item);
            continue;
        }
        // By area: as sample() has it.
        const Sequence sequence(1, item, 2, 0);
        const Lanes lanes = lanes_of(1, 0, 8)[0];
        const Drawn drawn = draw(seen, receiver, *stage.bvh, options, sequence, 3, lanes);
        for (unsigned i = 0; i < lanes.count; ++i) {
            const LightSample there = sample(rect, p, sequence.at(i, 3));
            const double cos_n = dot(receiver.frame.n, there.wi);
            const double cos_i = options.two_sided ? std::abs(cos_n) : std::max(0.0, cos_n);
            EXPECT_EQ(drawn.E[i], cos_i > 0.0 ? cos_i / there.pdf : 0.0);
        }
    }
}

TEST(Draws, LanesAreEveryPointOfEveryReplicateInTheirOrder)
{
    std::vector<std::pair<std::uint32_t, std::uint32_t>> points;
    for (const Lanes& lanes : lanes_of(32, 3, 11)) {
        ASSERT_TRUE(lanes.count >= 1 && lanes.count <= Lanes::most);
        for (unsigned i = 0; i < lanes.count; ++i) {
            points.emplace_back(lanes.replicate[i], lanes.point[i]);
        }
    }
    ASSERT_EQ(points.size(), 32U * 8U);
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        EXPECT_EQ(points[i], std::make_pair(i / 8, 3 + i % 8));
    }
}

TEST(Draws, FewLanesAreTheSameAsMany)
{
    const Stage stage = test::staged(test::icosphere(2));
    const Receiver receiver = receiver_at({0, 0, 1.5}, normalize({0.1, 0.2, 1.0}));
    const RectView view(RectLight{{0, 0, 3}, {0, 1, 0}, {1, 0, 0}, false}, receiver.p);
    const Sequence sequence(1, 5, 2, 0);
    const Lanes all = lanes_of(8, 0, 8)[0];
    const Drawn many = draw(view, receiver, *stage.bvh, {}, sequence, 0, all);
    for (unsigned i = 0; i < all.count; ++i) {
        Lanes one;
        one.count = 1;
        one.replicate[0] = all.replicate[i];
        one.point[0] = all.point[i];
        const Drawn alone = draw(view, receiver, *stage.bvh, {}, sequence, 0, one);
        EXPECT_EQ(alone.E[0], many.E[i]);
        EXPECT_EQ(alone.x[0], many.x[i]);
        EXPECT_EQ(alone.distance[0], many.distance[i]);
    }
}

}  // namespace
}  // namespace relight
