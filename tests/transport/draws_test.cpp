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

/// The slot's ray, as it was put.
ShadowRay ray_of(ShadowStream& stream, std::size_t slot)
{
    const RayFields& f = stream.fields();
    return {{f.origin_x[slot], f.origin_y[slot], f.origin_z[slot]},
            unit_already({f.direction_x[slot], f.direction_y[slot], f.direction_z[slot]}),
            f.from[slot],
            f.distance[slot]};
}

/// It is what ShadowStream::put() writes, or is passed over.
void expect_as_put(ShadowStream& stream, std::size_t slot, const Bvh& bvh, bool passed_over)
{
    const RayFields& f = stream.fields();
    const BoxRay box = bvh.box().ray(ray_of(stream, slot));
    if (passed_over) {
        ASSERT_EQ(f.tfar[slot], -std::numeric_limits<float>::infinity());
        return;
    }
    ASSERT_EQ(f.tfar[slot], box.tfar);
    ASSERT_EQ(f.tnear[slot], box.tnear);
    ASSERT_EQ(f.org_x[slot], box.org_x);
    ASSERT_EQ(f.org_y[slot], box.org_y);
    ASSERT_EQ(f.org_z[slot], box.org_z);
    ASSERT_EQ(f.dir_x[slot], box.dir_x);
    ASSERT_EQ(f.dir_y[slot], box.dir_y);
    ASSERT_EQ(f.dir_z[slot], box.dir_z);
}

constexpr double ulps = 1e-15;  // of products in another order

/// Rays of `view` against one sample after the other: what each brings within some roundings; where
/// it goes within 16, of the coordinates too, which the scalar function adds before it subtracts.
template <class View>
void expect_the_scalar_rays(const View& view, const Receiver& receiver, const Stage& stage,
                            const TransportOptions& options, std::uint64_t key)
{
    const Sequence sequence(1, key, 2, 0);
    // Beside others, whose vectors reach into each other's slots.
    const std::vector<Asker<View>> askers(3, {view, &receiver, sequence});
    ShadowStream stream(*stage.bvh);
    Brought E;
    for (const Lanes& lanes : lanes_of(7, 1, 12)) {
        draw<View>(askers, *stage.bvh, options, 3, lanes, stream, E);
        ASSERT_EQ(stream.size(), 3 * lanes.count);
        for (unsigned slot = 0; slot < stream.size(); ++slot) {
            const unsigned i = slot % lanes.count;
            const Sample2 s = sequence.replicate(lanes.replicate[i]).at(lanes.point[i], 3);
            LightSample there;
            if (view.is_seen()) { there = view.sample_direction(s); }
            const double cos_n = dot(receiver.frame.n, there.wi);
            const double cos_i = options.two_sided ? std::abs(cos_n) : std::max(0.0, cos_n);
            const double brought = cos_i > 0.0 ? there.L.r * cos_i / there.pdf : 0.0;
            ASSERT_NEAR(E[slot], brought, ulps * brought);
            expect_as_put(stream, slot, *stage.bvh, brought == 0.0);
            if (!(brought > 0.0)) { continue; }
            const ShadowRay ray = ray_of(stream, slot);
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
        ShadowStream stream(*stage.bvh);
        Brought E;
        const std::vector<Asker<RectView>> asker{{seen, &receiver, sequence}};
        draw<RectView>(asker, *stage.bvh, options, 3, lanes, stream, E);
        for (unsigned i = 0; i < lanes.count; ++i) {
            const LightSample there = sample(rect, p, sequence.at(i, 3));
            const double cos_n = dot(receiver.frame.n, there.wi);
            const double cos_i = options.two_sided ? std::abs(cos_n) : std::max(0.0, cos_n);
            const double brought = cos_i > 0.0 ? cos_i / there.pdf : 0.0;
            EXPECT_NEAR(E[i], brought, ulps * brought);
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
    ShadowStream stream(*stage.bvh);
    Brought many, alone;
    const std::vector<Asker<RectView>> asker{{view, &receiver, sequence}};
    draw<RectView>(asker, *stage.bvh, {}, 0, all, stream, many);
    std::vector<ShadowRay> rays;
    for (unsigned i = 0; i < all.count; ++i) { rays.push_back(ray_of(stream, i)); }
    for (unsigned i = 0; i < all.count; ++i) {
        Lanes one;
        one.count = 1;
        one.replicate[0] = all.replicate[i];
        one.point[0] = all.point[i];
        draw<RectView>(asker, *stage.bvh, {}, 0, one, stream, alone);
        EXPECT_EQ(alone[0], many[i]);
        EXPECT_EQ(ray_of(stream, 0).direction, rays[i].direction);
        EXPECT_EQ(ray_of(stream, 0).distance, rays[i].distance);
    }
}

/// Lanes of a sky that a receiver draws, and what is seen along them, beside its view's.
void expect_the_views_sky(const LightShape& shape, const Dome& dome)
{
    const Stage stage = test::staged(test::icosphere(2));
    const Receiver receiver = receiver_at({0, 0, 1.5}, normalize({0.1, 1.0, 0.3}));
    const Sequence sequence(1, 5, 2, 0);
    const LightView sky = view(shape, receiver.p);
    ShadowStream stream(*stage.bvh);
    Brought E;
    DomeLanes drawn, looked;
    std::fill(std::begin(drawn.pick), std::end(drawn.pick), 2.0);  // what is not drawn
    const std::vector<Asker<DomeDirections>> askers(3, {{&dome, &drawn}, &receiver, sequence});
    const Lanes lanes = lanes_of(8, 0, 8)[0];
    draw<DomeDirections>(askers, *stage.bvh, {}, 0, lanes, stream, E);
    ASSERT_EQ(stream.size(), 3 * lanes.count);
    for (unsigned slot = 0; slot < stream.size(); ++slot) {
        const Vec3 wi = ray_of(stream, slot).direction;
        looked.x[slot] = wi.x, looked.y[slot] = wi.y, looked.z[slot] = wi.z;
    }
    look(dome, stream.size(), looked);
    for (unsigned slot = 0; slot < stream.size(); ++slot) {
        const unsigned i = slot % lanes.count;
        const Sequence own = sequence.replicate(lanes.replicate[i]);
        const LightSample there =
            sample(sky, own.at(lanes.point[i], 0), own.at(lanes.point[i], 1).u);
        ASSERT_TRUE(there.wi);
        EXPECT_LE(length(Vec3(ray_of(stream, slot).direction) - there.wi), 1e-15);
        for (const SeenLanes* seen : {&drawn.seen, &looked.seen}) {
            EXPECT_NEAR(seen->pdf[slot], there.pdf, 1e-14 * there.pdf);
            EXPECT_NEAR(seen->red[slot], there.L.r, 1e-14 * there.L.r);
            EXPECT_NEAR(seen->green[slot], there.L.g, 1e-14 * there.L.g);
            EXPECT_NEAR(seen->blue[slot], there.L.b, 1e-14 * there.L.b);
        }
        const double cos_i = std::max(0.0, dot(receiver.frame.n, there.wi));
        EXPECT_NEAR(E[slot], cos_i, 1e-15);
        expect_as_put(stream, slot, *stage.bvh, E[slot] == 0.0);
    }
    // Anywhere else too: below the horizon, along the axes, at the rim of the sun's disc.
    std::vector<Dir3> ways{normalize({0, 1, 0}),  normalize({0, -1, 0}), normalize({1, 0, 0}),
                           normalize({-1, 0, 0}), normalize({0, 0, 1}),  normalize({0, 0, -1})};
    for (std::uint64_t item = 0; item < 500; ++item) {
        ways.push_back(normalize(Number{item}.vector(1.0)));
        const Vec3 aside = Number{item + 1000}.vector(0.006);
        ways.push_back(normalize(Vec3(normalize({0.5, 0.7, 0.3})) + aside));
    }
    for (std::size_t i = 0; i < ways.size(); ++i) {
        looked.x[i] = ways[i].x(), looked.y[i] = ways[i].y(), looked.z[i] = ways[i].z();
    }
    look(dome, ways.size(), looked);
    for (std::size_t i = 0; i < ways.size(); ++i) {
        const LightSample there = look(sky, ways[i]);
        EXPECT_NEAR(looked.seen.pdf[i], there.pdf, 1e-14 * there.pdf);
        EXPECT_NEAR(looked.seen.red[i], there.L.r, 1e-14 * there.L.r);
        EXPECT_NEAR(looked.seen.green[i], there.L.g, 1e-14 * there.L.g);
        EXPECT_NEAR(looked.seen.blue[i], there.L.b, 1e-14 * there.L.b);
    }
}

EnvironmentLight motley_sky(double rotation, float least)
{
    Image image{16, 8, {}, {}};
    for (int i = 0; i < 128; ++i) {
        const float L = least + static_cast<float>(uniform(3, static_cast<std::uint64_t>(i), 0, 0));
        image.pixels.push_back({L, 2.0F * L, least == 0.0F && i % 7 == 0 ? 9.0F : 0.0F});
    }
    return {std::make_shared<const EnvironmentMap>(std::move(image)), rotation};
}

TEST(Draws, AMapsDirectionsAreThoseOfItsView)
{
    const EnvironmentLight uneven = motley_sky(0.7, 0.0F), even = motley_sky(-2.0, 5.0F);
    ASSERT_FALSE(uneven.map->is_even());
    ASSERT_TRUE(even.map->is_even());
    expect_the_views_sky(uneven, dome_of(uneven));
    expect_the_views_sky(even, dome_of(even));
}

TEST(Draws, AMapsLampsAreFoundInTheDark)  // far from where the guides have one begin to look
{
    Image image{301, 40, {}, {}};
    for (std::uint64_t i = 0; i < image.at(0, image.height); ++i) {
        const bool is_lamp = uniform(5, i, 0, 0) < 0.01, is_black = i / 50 % 2 == 0;
        const float L = is_lamp ? 1e5F : is_black ? 0.0F : 1.0F;
        image.pixels.push_back({L, 0.01F * static_cast<float>(i) * L, L});
    }
    const EnvironmentLight sky{std::make_shared<const EnvironmentMap>(std::move(image)), 0.7};
    expect_the_views_sky(sky, dome_of(sky));
}

TEST(Draws, ASkysDirectionsAreThoseOfItsView)
{
    const SkyLight whole = make_sky(normalize({0.5, 0.7, 0.3}), 3.0);
    expect_the_views_sky(whole, dome_of(whole));
    SkyLight sunless = whole;
    sunless.sun_E_perp = {};
    expect_the_views_sky(sunless, dome_of(sunless));
    SkyLight sun_alone = whole;
    sun_alone.dome = nullptr;
    expect_the_views_sky(sun_alone, dome_of(sun_alone));
    SkyLight sun_in_the_dark = whole;
    sun_in_the_dark.dome =
        std::make_shared<const EnvironmentMap>(Image{4, 2, std::vector<Rgbf>(8), {}});
    expect_the_views_sky(sun_in_the_dark, dome_of(sun_in_the_dark));
}

/// A ball of shining faces, of many colours.
EmitterTable shining_ball(Vec3 centre)
{
    const Mesh ball = test::icosphere(1);
    std::vector<Emitter> emitters;
    for (std::uint32_t t = 0; t < ball.faces.count(); ++t) {
        Emitter emitter{{}, t, {1.0 + t, 0.5, 2.0}};
        for (std::size_t c = 0; c < 3; ++c) {
            emitter.corners[c] =
                ball.positions[ball.faces.indices[std::size_t{3} * t + c]] + centre;
        }
        emitters.push_back(emitter);
    }
    return EmitterTable(std::move(emitters));
}

/// Slots of lanes drawn beside `expected(i)`, the scalar functions' sample of the i-th lane.
template <class View, class Expected>
void expect_the_faces(const View& view, const MeshLanes& drawn, const Receiver& receiver,
                      const Stage& stage, const TransportOptions& options, const Sequence& sequence,
                      const Expected& expected)
{
    const Bvh& bvh = *stage.bvh;
    const std::vector<Asker<View>> askers(3, {view, &receiver, sequence});
    const Lanes lanes = lanes_of(8, 1, 9)[0];
    ShadowStream stream(bvh);
    Brought E;
    draw<View>(askers, bvh, options, 2, lanes, stream, E);
    ASSERT_EQ(stream.size(), 3 * lanes.count);
    for (unsigned slot = 0; slot < stream.size(); ++slot) {
        const unsigned i = slot % lanes.count;
        const LightSample there = expected(sequence.replicate(lanes.replicate[i]), lanes.point[i]);
        const double cos_n = dot(receiver.frame.n, there.wi);
        const double cos_i = options.two_sided ? std::abs(cos_n) : std::max(0.0, cos_n);
        ASSERT_NEAR(E[slot], there.wi ? cos_i : 0.0, 1e-12);
        expect_as_put(stream, slot, bvh, E[slot] == 0.0);
        if (!(E[slot] > 0.0)) { continue; }
        ASSERT_EQ(drawn.seen.L(slot), there.L);
        ASSERT_NEAR(drawn.seen.pdf[slot], there.pdf, 1e-11 * there.pdf);
        const ShadowRay ray = ray_of(stream, slot);
        const ShadowRay aimed =
            shadow_ray(bvh, receiver, there.wi, short_of_face(bvh, there.distance), options);
        ASSERT_EQ(ray.origin, aimed.origin);
        ASSERT_LE(length(Vec3(ray.direction) - aimed.direction), 1e-11);
        ASSERT_NEAR(ray.distance, aimed.distance, 1e-11 * aimed.distance);
    }
}

TEST(Draws, ShiningFacesAreThoseOfTheirTable)
{
    const Stage stage = test::staged(test::icosphere(2));
    const EmitterTable faces = shining_ball({0.3, 2.0, 1.0});
    for (std::uint64_t item = 0; item < 60; ++item) {
        Number number{item};
        TransportOptions options;
        options.two_sided = item % 3 == 0;
        const Receiver receiver = receiver_at(Point3{0, 0, 1.5} + number.vector(0.4),
                                              normalize(number.vector(1.0) + Vec3{0, 1, 0}));
        const Sequence sequence(1, item, 2, 0);
        MeshLanes drawn;
        expect_the_faces(MeshDirections{&faces, &drawn}, drawn, receiver, stage, options, sequence,
                         [&](const Sequence& own, unsigned point) {
                             return faces.sample(receiver.p, own.at(point, 2), own.at(point, 3).u);
                         });
        const CosineView cosine(receiver.frame, options.two_sided);
        expect_the_faces(MeshCosines{cosine, &faces, &drawn}, drawn, receiver, stage, options,
                         sequence, [&](const Sequence& own, unsigned point) {
                             const Dir3 wi = cosine.sample_direction(own.at(point, 2)).wi;
                             return faces.look_along(ray_start(receiver, wi), receiver.p, wi);
                         });
    }
}

}  // namespace
}  // namespace relight
