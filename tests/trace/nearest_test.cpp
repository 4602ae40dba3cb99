#include "tests/trace/model.h"

namespace relight {
namespace {

using namespace test;

TEST(Nearest, ARayThatStartsOnASurfaceMeetsTheNextThingAndHonoursFromAndDistance)
{
    const Mesh floor = test::grid(3);
    const Model model(
        test::joined(floor, test::moved(test::grid(3), test::upright(), 1.0, {0, 0, 0.5})));
    const Point3 on_floor{0.1, 0.2, 0.0};
    EXPECT_NEAR(model.bvh.nearest(on_floor, up).distance, 0.5, 1e-15);
    EXPECT_NEAR(model.bvh.nearest(on_floor - Vec3{0, 0, 1}, up).distance, 1.0, 1e-15);
    EXPECT_NEAR(model.bvh.nearest(on_floor - Vec3{0, 0, 1}, up, 1.0 + 1e-9).distance, 1.5, 1e-15);
    EXPECT_EQ(model.bvh.nearest(on_floor, up, 0.6).primitive, ~0U);
    const auto hits =
        model.nearest({{on_floor, up, 0.0, 0.5 - 1e-9}, {on_floor, up, 0.0, 0.5 + 1e-9}});
    EXPECT_EQ(hits[0].primitive, ~0U);
    EXPECT_NE(hits[1].primitive, ~0U);
    // From far outside as well, where the ray is stepped up to the model first.
    const Point3 eye = on_floor + Vec3{0, 0, 1e6};
    EXPECT_NEAR(model.bvh.nearest(eye, -up, 1e6 - 0.25).distance, 1e6, 1e-9);
    EXPECT_EQ(model.bvh.nearest(eye, -up, 1e6 + 1e-6).primitive, ~0U);
    EXPECT_EQ(model.nearest({{eye, -up, 0.0, 1e6 - 0.5 - 1e-6}})[0].primitive, ~0U);
}

TEST(Nearest, ManyAtOnceAreTheSameAsOneByOneToTheLastBit)
{
    Numbers numbers;
    Mesh cloud = test::icosphere(3);
    cloud.faces = {};
    for (const Point3 p : cloud.positions) { cloud.normals.push_back(p - Point3{}); }
    for (const Mesh& mesh : {test::latlong_sphere(20, 40), test::grid(12), cloud}) {
        const Model model(mesh);
        std::vector<ShadowRay> rays;
        for (const Point3 p :
             mesh.positions) {  // at corners and edges, from near and far, and away
            for (const double distance : {1e-3, 1.0, 1e4}) {
                const Dir3 d = numbers.direction();
                rays.push_back({p - Vec3(d) * distance, d, numbers.in(0.0, 1e-3), far});
                rays.push_back({p + Vec3(d) * distance, d, 0.0, far});
            }
            rays.push_back({p, numbers.direction(), 0.0, numbers.in(0.0, 1.0)});
        }
        const std::vector<Hit> hits = model.nearest(rays);
        std::size_t met = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            Hit one;
            model.bvh.nearest({&rays[i], 1}, {&one, 1});
            EXPECT_EQ(one.primitive, hits[i].primitive);
            EXPECT_EQ(one.distance, hits[i].distance);
            EXPECT_EQ(one.u, hits[i].u);
            EXPECT_EQ(one.v, hits[i].v);
            if (rays[i].distance == far) {
                const Hit alone =
                    model.bvh.nearest(rays[i].origin, rays[i].direction, rays[i].from);
                EXPECT_EQ(alone.primitive, hits[i].primitive);
                EXPECT_EQ(alone.distance, hits[i].distance);
            }
            met += one.primitive != ~0U ? 1 : 0;
        }
        EXPECT_GT(met, rays.size() / 5);
        EXPECT_LT(met, rays.size());
    }
}

TEST(Nearest, RaysFromOnePlaceMeetWhatEachMeetsAlone)  // a camera's are traced as packets
{
    Numbers numbers;
    Mesh cloud = test::icosphere(3);
    cloud.faces = {};
    for (const Point3 p : cloud.positions) { cloud.normals.push_back(Point3{} - p); }
    Mesh twice = test::latlong_sphere(20, 40);  // every face filed twice
    const std::vector<std::uint32_t> once = twice.faces.indices;
    twice.faces.indices.insert(twice.faces.indices.end(), once.begin(), once.end());
    for (const Mesh& mesh : {twice, test::box({-1, -2, -3}, {3, 2, 1}), cloud}) {
        const Model model(mesh);
        for (const Point3 eye : {Point3{0.1, 0.2, -0.3}, Point3{0.01, 0.5, 0.2}}) {
            std::vector<ShadowRay> rays;
            for (int k = 0; k < 3000; ++k) {
                rays.push_back({eye, numbers.direction(), 0.0, far});
                rays.push_back({eye, numbers.direction(), 0.0, numbers.in(0.0, 2.0)});
                rays.push_back({eye, numbers.direction(), numbers.in(0.0, 2.0), far});
            }
            for (const Point3 p : mesh.positions) {  // corners, and edges
                const Point3 q = p + (mesh.positions[0] - p) * numbers.in(0.0, 1.0);
                rays.push_back({eye, normalize(p - eye), 0.0, far});
                rays.push_back({eye, normalize(q - eye), 0.0, far});
            }
            const std::vector<Hit> hits = model.nearest(rays);
            std::size_t met = 0;
            for (std::size_t i = 0; i < rays.size(); ++i) {
                const Hit one = model.nearest({rays[i]})[0];
                ASSERT_EQ(one.primitive == ~0U, hits[i].primitive == ~0U) << i;
                EXPECT_NEAR(one.distance, hits[i].distance, 1e-12);
                if (i < 9000) { EXPECT_EQ(one.primitive, hits[i].primitive) << i; }
                met += one.primitive != ~0U ? 1 : 0;
            }
            EXPECT_GT(met, rays.size() / 3);
            EXPECT_LT(met, rays.size());
        }
    }
}

TEST(Nearest, WhatIsMetIsWhatBlocks)
{
    Numbers numbers;
    const Model model(test::joined(
        test::grid(5), test::moved(test::icosphere(2), test::upright(), 0.3, {0.1, 0.05, 0.4})));
    std::size_t met = 0;
    for (int k = 0; k < 5000; ++k) {
        const ShadowRay ray{{numbers.in(-1, 1), numbers.in(-1, 1), numbers.in(-0.2, 1)},
                            numbers.direction(),
                            numbers.in(0.0, 0.2),
                            numbers.in(0.3, 2.0)};
        const Hit hit = model.nearest({ray})[0];
        EXPECT_EQ(hit.primitive != ~0U, model.blocked(ray));
        if (hit.primitive == ~0U) { continue; }
        ++met;
        EXPECT_GT(hit.distance, ray.from - 1e-6);
        EXPECT_LT(hit.distance, ray.distance + 1e-6);
    }
    EXPECT_GT(met, 500U);
}

}  // namespace
}  // namespace relight
