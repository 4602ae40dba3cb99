#include "tests/light/area_situations.h"

namespace relight {
namespace {

using std::numbers::pi;
using test::Numbers;

TEST(AreaSampling, LookingTellsWhatWasDrawn)
{
    std::uint64_t item = 0;
    for (const test::Situation& light : test::situations()) {
        SCOPED_TRACE(light.name);
        Numbers random(item++);
        for (int i = 0; i < 1000; ++i) {
            const LightSample drawn = light.draw(random);
            ASSERT_TRUE(drawn.wi);
            const LightSample seen = light.at(drawn.wi);
            if (!seen.wi) {  // within rounding of its edge
                const auto around = [&](Vec3 aside) {
                    return bool(light.at(normalize(Vec3(drawn.wi) + aside * 1e-9)).wi);
                };
                EXPECT_TRUE(around({1, 0, 0}) || around({-1, 0, 0}) || around({0, 1, 0}) ||
                            around({0, -1, 0}) || around({0, 0, 1}) || around({0, 0, -1}));
                continue;
            }
            EXPECT_EQ(seen.L, drawn.L);
            EXPECT_NEAR(seen.pdf, drawn.pdf, 1e-9 * drawn.pdf);
            if (is_finite(drawn.distance)) {
                EXPECT_NEAR(seen.distance, drawn.distance, 1e-9 * drawn.distance);
            } else {
                EXPECT_EQ(seen.distance, drawn.distance);
            }
        }
    }
}

/// Integrals over all directions, taken over the disk itself: dw = cos dA / d^2.
TEST(DiskSampling, DensityIntegratesToOneAndIsNearlyUniform)
{
    for (const Point3 p : {Point3{0, 0, 2}, Point3{0.5, 0.2, 0.4}, Point3{3, 1, 0.2},
                           Point3{0.99, 0, 0.1}, Point3{40, 0, 30}}) {
        const DiskLight disk{{}, normalize({0, 0, 1}), 1.0};
        constexpr int rings = 400, turns = 400;
        double integral = 0.0, Omega = 0.0, least = 1e300, largest = 0.0;
        for (int i = 0; i < rings; ++i) {
            for (int j = 0; j < turns; ++j) {
                const double r = (i + 0.5) / rings, phi = 2.0 * pi * (j + 0.5) / turns;
                const Vec3 to = Point3{r * std::cos(phi), r * std::sin(phi), 0.0} - p;
                const double d = length(to), patch = r / rings * 2.0 * pi / turns;
                const double dw = patch * p.z / (d * d * d);
                const double pdf = look(disk, p, normalize(to)).pdf;
                Omega += dw;
                integral += pdf * dw;
                least = std::min(least, pdf);
                largest = std::max(largest, pdf);
            }
        }
        EXPECT_NEAR(integral, 1.0, 5e-4);  // of the midpoint rule at the rim
        EXPECT_LE(largest, 2.0 * least);
        EXPECT_GE(least * Omega, 0.5);
        EXPECT_LE(largest * Omega, 2.0);
    }
}

TEST(AreaSampling, AgreesWithTheClosedFormAnywhere)
{
    test::Deviations deviations;
    const auto add = [&](const auto& light, Point3 p, Dir3 n, Numbers& random) {
        const double exact = irradiance(light, p, n);
        const auto draw = [&] {
            const Sample2 s = random.square();
            return sample(LightShape(light), p, s, random.next());
        };
        const test::Estimate by_samples = test::estimate(draw, n, 1024);
        // Of a sliver above the horizon too few samples tell for their error to be known.
        const Dir3 facing = draw().wi;
        if (exact <= 0.01 * irradiance(light, p, facing)) { return; }
        deviations.add(by_samples, exact);
    };
    for (std::uint64_t item = 400; item < 800; ++item) {
        Numbers random(item);
        const RectLight rect = test::some_rect(random);
        const DiskLight disk = test::some_disk(random);
        const SphereLight sphere = test::some_sphere(random);
        const Dir3 n = random.direction();
        const Point3 p = random.point(2.0);
        add(rect, p, n, random);
        add(disk, p, n, random);
        add(sphere, p, n, random);
        add(rect,
            rect.center + rect.edge_u * random.between(-0.5, 0.5) +
                cross(rect.edge_u, rect.edge_v) * random.scale(1e-10, 1e-2),
            n, random);
        add(disk,
            disk.center + Vec3(frame_around(disk.normal).x) * (disk.radius * random.next()) +
                Vec3(disk.normal) * (disk.radius * random.scale(1e-10, 1e-2)),
            n, random);
    }
    EXPECT_GT(deviations.z.size(), 500U);
    deviations.check();
}

/// Whatever the place and the light, what is computed is a number, and never negative.
TEST(AreaSampling, IsFiniteForAnyFiniteInput)
{
    const double sizes[] = {0.0, 1e-160, 1e-30, 1e-9, 1.0, 1e9, 1e30};
    const double offsets[] = {0.0, 1e-200, 1e-30, 1e-16, 1e-7, 0.5, 1.0, 1e8, 1e30};
    Numbers random(7);
    for (const double size : sizes) {
        const Vec3 u{size, 0, 0}, v{0, size, 0};
        const std::vector<LightShape> lights{
            RectLight{{}, u, v, true},   RectLight{{}, u, u},
            RectLight{{}, u, {}},        DiskLight{{}, normalize({0, 0, 1}), size},
            DiskLight{{}, {}, size},     SphereLight{{}, size},
            SphereLight{{0, 0, 1}, size}};
        for (const double x : offsets) {
            for (const double z : offsets) {
                for (const Point3 p :
                     {Point3{x, 0, z}, Point3{x * size, x * size, -z * size},
                      Point3{0.5 * size, 0.5 * size, z * size}, Point3{size, 0, z * size}}) {
                    for (const LightShape& light : lights) {
                        const double E = *closed_irradiance(light, p, random.direction());
                        EXPECT_TRUE(E >= 0.0 && E <= pi * (1.0 + 1e-12)) << E;
                        for (const Sample2 s : {Sample2{0x1p-33, 0x1p-33}, random.square(),
                                                Sample2{1.0 - 0x1p-33, 1.0 - 0x1p-33}}) {
                            const LightSample drawn = sample(light, p, s, random.next());
                            for (const LightSample& seen :
                                 {drawn,
                                  look(light, p, drawn.wi ? drawn.wi : random.direction())}) {
                                if (!seen.wi) { continue; }
                                EXPECT_TRUE(is_finite(Vec3(seen.wi)));
                                EXPECT_NEAR(length(seen.wi), 1.0, 1e-12);
                                EXPECT_TRUE(seen.distance >= 0.0 && is_finite(seen.distance));
                                EXPECT_TRUE(seen.pdf > 0.0 && is_finite(seen.pdf)) << seen.pdf;
                                EXPECT_EQ(seen.L, Rgb::grey(1.0));
                            }
                        }
                    }
                }
            }
        }
    }
}

}  // namespace
}  // namespace relight
