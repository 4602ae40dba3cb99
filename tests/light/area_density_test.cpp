#include "tests/chi2.h"
#include "tests/light/area_situations.h"

namespace relight {
namespace {

using test::Numbers;

/// A map of the sphere onto itself that widens what lies about an axis: tan(theta / 2) times k, the
/// plane of stereographic projection scaled. Lights that look small then fill the bins of a test.
struct Lens {
    Frame frame;
    double k = 1.0;

    /// About the mean direction of a light, wide open.
    static Lens onto(const test::Situation& light, Numbers random)
    {
        constexpr int draws = 500;
        std::vector<Vec3> at;
        Vec3 sum;
        for (int i = 0; i < draws; ++i) { sum += at.emplace_back(light.draw(random).wi); }
        Lens lens{frame_around(normalize(sum))};
        double squares = 0.0;
        for (const Vec3 w : at) {
            const Vec3 on_plane = lens.projected(w);
            squares += dot(on_plane, on_plane);
        }
        lens.k = std::max(1.0, std::sqrt(draws / squares));
        return lens;
    }
    Vec3 projected(Vec3 w) const
    {
        const double one_plus_cos = 0.5 * dot(w + frame.n, w + frame.n);
        return Vec3{dot(w, frame.x), dot(w, frame.y), 0.0} / one_plus_cos;
    }
    static Vec3 lifted(Vec3 on_plane)
    {
        const double t2 = dot(on_plane, on_plane);
        return (on_plane * 2.0 + Vec3{0.0, 0.0, 1.0 - t2}) / (1.0 + t2);
    }
    Vec3 widened(Vec3 w) const { return lifted(projected(w) * k); }
    Vec3 narrowed(Vec3 v) const
    {
        return frame.to_world(lifted(Vec3{v.x, v.y, 0.0} / (k * (1.0 + v.z))));
    }
    /// dw / dv at v: the projection has the density (1 + t^2)^2 / 4.
    double shrinks(Vec3 v) const
    {
        const double t2 = (1.0 - v.z) / (1.0 + v.z), ratio = (1.0 + t2) / (1.0 + t2 / (k * k));
        return ratio * ratio / (k * k);
    }
};

TEST(AreaSampling, OfRoundLightsDrawsFromTheDensityItClaims)
{
    std::uint64_t item = 0;
    for (const test::Situation& light : test::round_lights()) {
        SCOPED_TRACE(light.name);
        Numbers random(item++);
        const Lens lens = Lens::onto(light, random);
        const test::Chi2 chi2 = test::chi2_directions(
            [&](int) -> Vec3 { return lens.widened(light.draw(random).wi); },
            [&](Vec3 v) { return light.at(normalize(lens.narrowed(v))).pdf * lens.shrinks(v); },
            10000);
        EXPECT_GT(chi2.p, 1e-3) << chi2.statistic << " of " << chi2.degrees;
        EXPECT_NEAR(chi2.integral, 1.0, 5e-3);  // the light's edge cuts bins
    }
}

/// Pearson's test against the solid angles of small triangles: a triangle is halved until none of
/// its parts holds more than a 128th of the directions. Corners are given from the place.
struct Parts {
    double per_steradian;  ///< directions expected
    double statistic = 0.0, bins = 0.0;

    void count(const std::array<Point3, 3>& t, const std::vector<Vec3>& inside)
    {
        const double expected = per_steradian * solid_angle(t, {});
        if (expected < 160.0) {
            const double excess = static_cast<double>(inside.size()) - expected;
            statistic += excess * excess / expected;
            bins += 1.0;
            return;
        }
        const auto length2 = [&](std::size_t i) {
            const Vec3 edge = t[(i + 1) % 3] - t[i];
            return dot(edge, edge);
        };
        std::size_t longest = 0;
        for (const std::size_t i : {std::size_t{1}, std::size_t{2}}) {
            longest = length2(i) > length2(longest) ? i : longest;
        }
        const Point3 a = t[longest], b = t[(longest + 1) % 3], c = t[(longest + 2) % 3];
        const Point3 middle = a + (b - a) * 0.5;
        const Vec3 wall = cross(middle - Point3{}, c - Point3{});
        std::vector<Vec3> on_a, on_b;
        for (const Vec3 w : inside) {
            (dot(w, wall) * dot(a - Point3{}, wall) > 0.0 ? on_a : on_b).push_back(w);
        }
        count({a, middle, c}, on_a);
        count({middle, b, c}, on_b);
    }
    double p() const { return test::gamma_q(0.5 * (bins - 1.0), 0.5 * statistic); }
};

TEST(TriangleSampling, IsUniformInSolidAngle)
{
    constexpr int draws = 20000;
    std::uint64_t item = 100;
    for (const test::Flat& light : test::flat_lights()) {
        SCOPED_TRACE(light.seen.name);
        Numbers random(item++);
        std::vector<std::vector<Vec3>> inside(light.triangles.size());
        double Omega = 0.0;
        for (const auto& triangle : light.triangles) { Omega += solid_angle(triangle, light.p); }
        for (int i = 0; i < draws; ++i) {
            const LightSample drawn = light.seen.draw(random);
            EXPECT_NEAR(drawn.pdf, 1.0 / Omega, 1e-3 / Omega);  // far ones are drawn by area
            std::size_t part = 0;
            while (part + 1 < inside.size() &&
                   !look_at_triangle(light.triangles[part], light.p, drawn.wi).wi) {
                ++part;
            }
            inside[part].push_back(drawn.wi);
        }
        Parts parts{draws / Omega};
        for (std::size_t i = 0; i < inside.size(); ++i) {
            std::array<Point3, 3> from_p = light.triangles[i];
            for (Point3& q : from_p) { q = Point3{} + (q - light.p); }
            parts.count(from_p, inside[i]);
        }
        EXPECT_GT(parts.p(), 1e-3) << parts.statistic << " of " << parts.bins;
        EXPECT_GT(parts.bins, 100.0);
    }
}

/// As near as double can put it: the corners seem to be on one great circle, but what is seen is
/// the hemisphere.
TEST(TriangleSampling, FillsTheHemisphereOfAReceiverThatTouchesIt)
{
    constexpr int draws = 1000;
    int touching = 0;
    for (std::uint64_t item = 0; item < 100; ++item) {
        Numbers random(item);
        const std::array<Point3, 3> t{random.point(1.0), random.point(1.0), random.point(1.0)};
        const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
        if (length(normal) < 0.2) { continue; }
        const Vec3 to_middle = ((t[1] - t[0]) + (t[2] - t[0])) / 3.0;
        const Point3 p = t[0] + to_middle + Vec3(normalize(normal)) * 1e-16;
        if (solid_angle(t, p) == 0.0) { continue; }  // rounded onto its plane
        ++touching;
        Vec3 sum;
        for (int i = 0; i < draws; ++i) {
            const LightSample drawn = sample_triangle(t, p, random.square());
            ASSERT_TRUE(drawn.wi);
            EXPECT_TRUE(look_at_triangle(t, p, drawn.wi).wi);
            sum += drawn.wi;
        }
        const Frame frame = frame_around(normalize(normal));
        const Vec3 mean = frame.to_local(sum) / draws;
        EXPECT_NEAR(std::abs(mean.z), 0.5, 4.0 * std::sqrt(1.0 / 12.0 / draws));
        EXPECT_NEAR(mean.x, 0.0, 4.0 * std::sqrt(1.0 / 3.0 / draws));
        EXPECT_NEAR(mean.y, 0.0, 4.0 * std::sqrt(1.0 / 3.0 / draws));
    }
    EXPECT_GT(touching, 50);
}

}  // namespace
}  // namespace relight
