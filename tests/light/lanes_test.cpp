// What is computed in vectors, beside the scalar functions that it stands for.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/base/random.h"
#include "core/base/warp.h"
#include "core/light/rect_light.h"

namespace relight {
namespace {

struct Number {
    std::uint64_t item, next = 0;
    double between(double a, double b) { return a + (b - a) * uniform(23, item, next++, 0); }
    Vec3 vector(double size)
    {
        return {between(-size, size), between(-size, size), between(-size, size)};
    }
};

TEST(Warp, AnglesAreThoseOfTheLibrary)
{
    EXPECT_EQ(warp::angle_above(0.0, 0.0), 0.0);
    EXPECT_EQ(warp::angle_above(0.0, 3.0), 0.0);
    EXPECT_EQ(warp::angle_above(0.0, -3.0), std::numbers::pi);
    EXPECT_EQ(warp::angle_above(2.0, 0.0), 0.5 * std::numbers::pi);
    for (std::uint64_t item = 0; item < 100'000; ++item) {
        Number number{item};
        const double y = std::exp2(number.between(-60.0, 60.0));
        const double x =
            std::copysign(std::exp2(number.between(-60.0, 60.0)), number.between(-1.0, 1.0));
        const double close = y * number.between(-3.0, 3.0);
        ASSERT_NEAR(warp::angle_above(y, x), std::atan2(y, x), 4.5e-16 * std::atan2(y, x));
        ASSERT_NEAR(warp::angle_above(y, close), std::atan2(y, close),
                    4.5e-16 * std::atan2(y, close));
    }
}

/// Rectangles of any shape seen from near and far, above, beside and behind, and cut by the
/// horizon.
struct Situations {
    static constexpr std::size_t off_the_plane = 100;  // no multiple of a vector; the rest in it
    RectLight light;
    std::vector<Point3> p;
    std::vector<Dir3> n;
};
Situations situations(std::uint64_t item)
{
    Number number{item};
    const double size = std::exp2(number.between(-20.0, 20.0));
    Situations some;
    some.light.center = Point3{} + number.vector(size);  // no digits lost in coordinates
    some.light.edge_u = number.vector(size);
    some.light.edge_v = number.vector(size * std::exp2(number.between(-6.0, 0.0)));
    some.light.two_sided = item % 2 == 1;
    for (std::size_t i = 0; i < Situations::off_the_plane; ++i) {
        const double away = size * std::exp2(number.between(-8.0, 12.0));
        some.p.push_back(some.light.center + number.vector(away));
        some.n.push_back(normalize(number.vector(1.0)));
    }
    const Vec3 to_corner = (some.light.edge_u + some.light.edge_v) * 0.5;
    for (const Vec3 aside : {Vec3{}, to_corner, some.light.edge_u}) {
        some.p.push_back(some.light.center + aside);
    }
    some.n.resize(some.p.size(), normalize({0, 0, 1}));
    return some;
}

TEST(RectLanes, TheirIrradianceIsThePolygons)
{
    for (std::uint64_t item = 0; item < 2000; ++item) {
        const Situations some = situations(item);
        std::vector<double> E(some.p.size());
        irradiance(some.light, some.p, some.n, E);
        for (std::size_t i = 0; i < E.size(); ++i) {
            ASSERT_TRUE(E[i] >= 0.0 && E[i] <= std::numbers::pi);
            if (i >= Situations::off_the_plane) { continue; }  // rounding says on which side
            const double expected = irradiance(some.light, some.p[i], some.n[i]);
            // An edge's angle has its roundings, whatever its neighbours take away again.
            const double far = length(some.light.center - some.p[i]);
            const double seen =
                std::min(1.0, (length(some.light.edge_u) + length(some.light.edge_v)) / far);
            ASSERT_NEAR(E[i], expected, 1e-12 * seen) << item << ' ' << i;
        }
        EXPECT_EQ(E[Situations::off_the_plane], 0.0);
    }
}

TEST(RectLanes, TheirDirectionsAreTheViews)
{
    std::size_t usual = 0, all = 0;
    for (std::uint64_t item = 0; item < 500; ++item) {
        const Situations some = situations(item);
        std::vector<RectDirections> seen(some.p.size());
        directions(some.light, some.p, seen);
        Number number{item + 10'000};
        for (std::size_t i = 0; i < seen.size(); ++i) {
            const RectView view(some.light, some.p[i]);
            ++all;
            if (seen[i].whole < 0.0) { continue; }  // RectView draws
            ++usual;
            ASSERT_EQ(seen[i].is_seen(), view.is_seen());
            if (!view.is_seen()) { continue; }
            ASSERT_FALSE(view.by_area());
            const Sample2 s{number.between(0.0, 1.0), number.between(0.0, 1.0)};
            const LightSample drawn = seen[i].sample_direction(s), expected = view.sample(s);
            ASSERT_NEAR(drawn.pdf, expected.pdf, 1e-8 * expected.pdf);
            const double across = std::sqrt(1.0 / expected.pdf);
            ASSERT_LE(length(Vec3(drawn.wi) - expected.wi), 1e-6 * across + 1e-12)
                << item << ' ' << i << ' ' << expected.pdf;
        }
    }
    EXPECT_GT(usual, all / 2);
}

}  // namespace
}  // namespace relight
