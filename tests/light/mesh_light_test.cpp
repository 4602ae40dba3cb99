#include "core/light/mesh_light.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/light/polygon.h"
#include "tests/chi2.h"
#include "tests/light/monte_carlo.h"

namespace relight {
namespace {

constexpr double pi = std::numbers::pi;

/// Three triangles overhead that shine down, side by side, of different size and colour; given in
/// no order.
std::vector<Emitter> overhead()
{
    return {{{Point3{1.0, 2.0, 0.0}, {2.0, 2.2, 0.3}, {1.0, 2.5, 1.2}}, 9, {3.0, 0.2, 0.1}},
            {{Point3{-1.5, 1.0, -0.5}, {-0.5, 1.2, -0.5}, {-1.0, 1.0, 0.5}}, 2, {0.5, 0.5, 4.0}},
            {{Point3{0.0, 1.5, -2.0}, {1.2, 1.5, -2.4}, {0.3, 1.5, -1.0}}, 5, {2.0, 3.0, 1.0}}};
}

Vec3 front(const Emitter& e)
{
    return cross(e.corners[1] - e.corners[0], e.corners[2] - e.corners[0]);
}

TEST(MeshLight, TheTestsTrianglesShineDown)
{
    for (const Emitter& e : overhead()) { EXPECT_LT(front(e).y, 0.0); }
}

TEST(MeshLight, FluxIsPiLAOfEveryTriangle)
{
    Rgb Phi;
    for (const Emitter& e : overhead()) { Phi += e.L * (0.5 * pi * length(front(e))); }
    const Rgb flux = EmitterTable(overhead()).flux();
    EXPECT_NEAR(flux.r / Phi.r, 1.0, 1e-14);
    EXPECT_NEAR(flux.g / Phi.g, 1.0, 1e-14);
    EXPECT_NEAR(flux.b / Phi.b, 1.0, 1e-14);
}

TEST(MeshLight, ItsSamplesGiveThePolygonsIrradiance)
{
    const EmitterTable table(overhead());
    const Point3 p{0.1, 0.2, -0.3};
    test::Offsets offsets;
    std::uint64_t seed = 0;
    for (const Vec3& normal : {Vec3{0, 1, 0}, Vec3{1, 1, 0}, Vec3{-1, 0.3, 0.2}, Vec3{0.2, 0.5, -1},
                               Vec3{0.9, 0.1, 0.9}, Vec3{-0.5, 1.0, 0.5}}) {
        const Dir3 n = normalize(normal);
        double E = 0.0;
        for (const Emitter& e : overhead()) {
            E += luminance(e.L) * polygon_irradiance(e.corners, p, n);
        }
        const test::Estimate estimate = test::irradiance_by_samples(
            [&](test::Draw d) { return table.sample(p, d.s, d.pick); }, n, 40000, ++seed);
        EXPECT_GT(E, 0.0);
        EXPECT_LE(std::abs(estimate.off(E)), 4.0) << estimate.mean << " for " << E;
        offsets.add(estimate.off(E));
    }
    EXPECT_LT(offsets.rms(), 2.0);
}

/// Bins of a triangle: fans around its first corner, cut across. Where r and t run from 0 to 1,
/// a + r ((1 - t) (b - a) + t (c - a)) covers it, dA = |(b - a) x (c - a)| r dr dt.
constexpr int bins = 5, bins_of_one = bins * bins;

Point3 place(const Emitter& e, double r, double t)
{
    const auto& [a, b, c] = e.corners;
    return a + r * ((1.0 - t) * (b - a) + t * (c - a));
}

/// The bin of the point where a direction from p meets the triangle's plane.
int bin_of(const Emitter& e, Point3 p, Dir3 wi)
{
    const auto& [a, b, c] = e.corners;
    const Vec3 n = front(e);
    const Vec3 q = p + Vec3(wi) * (dot(a - p, n) / dot(wi, n)) - a;
    const double u = dot(cross(q, c - a), n) / dot(n, n);
    const double v = dot(cross(b - a, q), n) / dot(n, n);
    const auto cell = [](double x) { return std::clamp(static_cast<int>(bins * x), 0, bins - 1); };
    return bins * cell(u + v) + cell(v / (u + v));
}

/// Probability of a bin by the density that look() claims: d omega = cos dA / d^2.
double probability(const EmitterTable& table, const Emitter& e, Point3 p, int bin)
{
    constexpr int steps = 20;
    double sum = 0.0;
    const int row = bin / bins, column = bin % bins;
    for (int k = 0; k < steps * steps; ++k) {
        const int i = k / steps, j = k % steps;
        const double r = (row + (i + 0.5) / steps) / bins;
        const double t = (column + (j + 0.5) / steps) / bins;
        const Vec3 to = place(e, r, t) - p;
        const double cosine_area = std::abs(dot(front(e), normalize(to))) * r;
        sum += table.look(e.primitive, p, normalize(to)).pdf * cosine_area / dot(to, to);
    }
    return sum / std::pow(steps * bins, 2);
}

TEST(MeshLight, IsDrawnFromTheDensityItClaims)
{
    constexpr int samples = 100000;
    const EmitterTable table(overhead());
    const Point3 p{0.1, 0.2, -0.3};
    std::vector<double> counts(overhead().size() * bins_of_one);
    for (int i = 0; i < samples; ++i) {
        const test::Draw d = test::draw(11, i);
        const LightSample drawn = table.sample(p, d.s, d.pick);
        std::size_t k = 0;
        for (const Emitter& e : overhead()) {  // each has a colour of its own
            if (drawn.L == e.L) {
                counts[k * bins_of_one + static_cast<std::size_t>(bin_of(e, p, drawn.wi))] += 1.0;
            }
            ++k;
        }
    }
    double statistic = 0.0, integral = 0.0;
    for (std::size_t k = 0; k < counts.size(); ++k) {
        const Emitter e = overhead()[k / bins_of_one];
        const double share = probability(table, e, p, static_cast<int>(k % bins_of_one));
        integral += share;
        statistic += std::pow(counts[k] - samples * share, 2) / (samples * share);
    }
    EXPECT_NEAR(integral, 1.0, 1e-5);
    const double degrees = static_cast<double>(counts.size()) - 1.0;
    EXPECT_GT(test::gamma_q(0.5 * degrees, 0.5 * statistic), 1e-3)
        << statistic << " of " << degrees;
}

TEST(MeshLight, ALookAtTheTriangleThatWasDrawnSeesTheSample)
{
    const EmitterTable table(overhead());
    const Point3 p{0.1, 0.2, -0.3};
    int drawn_of[3] = {};
    for (int i = 0; i < 3000; ++i) {
        const test::Draw d = test::draw(12, i);
        const LightSample drawn = table.sample(p, d.s, d.pick);
        ASSERT_TRUE(drawn.wi);
        int seen_by = 0, k = 0;
        for (const Emitter& e : overhead()) {
            const LightSample seen = table.look(e.primitive, p, drawn.wi);
            if (seen.pdf > 0.0 && std::abs(seen.distance / drawn.distance - 1.0) < 1e-9) {
                EXPECT_EQ(drawn.L, e.L);
                EXPECT_EQ(seen.L, e.L);
                EXPECT_NEAR(seen.pdf / drawn.pdf, 1.0, 1e-6);
                ++seen_by;
                ++drawn_of[k];
            }
            ++k;
        }
        EXPECT_LE(seen_by, 1);
    }
    double sum = 0.0;
    for (const Emitter& e : overhead()) { sum += luminance(e.L) * length(front(e)); }
    int k = 0;
    for (const Emitter& e : overhead()) {  // as often as luminance x area
        const double share = luminance(e.L) * length(front(e)) / sum;
        EXPECT_NEAR(drawn_of[k++] / 3000.0, share, 4.0 * std::sqrt(share * (1.0 - share) / 3000.0));
    }
}

TEST(MeshLight, ShinesOnlyOnItsFront)
{
    const Emitter one = overhead()[2];  // in the plane y = 1.5
    const EmitterTable table({one});
    const Point3 below{0.5, 0.5, -1.8}, above{0.5, 2.5, -1.8}, beside{5.0, 1.5, 3.0};
    const Dir3 up = normalize({0, 1, 0});
    EXPECT_TRUE(table.sample(below, {0.3, 0.4}, 0.5).wi);
    EXPECT_EQ(table.look(5, below, up).L, one.L);
    EXPECT_FALSE(table.sample(above, {0.3, 0.4}, 0.5).wi);
    EXPECT_EQ(table.look(5, above, -up).L, Rgb{});
    EXPECT_EQ(table.look(5, above, -up).pdf, 0.0);
    EXPECT_FALSE(table.sample(beside, {0.3, 0.4}, 0.5).wi);  // in its plane
    EXPECT_FALSE(table.look(5, below, -up).wi);              // looks away
    EXPECT_EQ(table.look(3, below, up).L, Rgb{});            // no such emitter
    EXPECT_EQ(table.radiance(5), one.L);
    EXPECT_EQ(table.radiance(3), Rgb{});
}

TEST(MeshLight, TrianglesWithoutAreaOrLightAreLeftOut)
{
    std::vector<Emitter> emitters = overhead();
    emitters.push_back({{Point3{1, 1, 1}, {1, 1, 1}, {2, 2, 2}}, 20, Rgb::grey(5.0)});
    emitters.push_back({{Point3{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}, 21, Rgb::grey(5.0)});
    emitters.push_back({{Point3{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 1, Rgb{}});
    const double inf = std::numeric_limits<double>::infinity();
    emitters.push_back({{Point3{0, 0, 0}, {1, 0, 0}, {0, inf, 0}}, 0, Rgb::grey(1.0)});
    const EmitterTable table(emitters);
    EXPECT_EQ(table.size(), 3U);
    EXPECT_EQ(table.flux(), EmitterTable(overhead()).flux());
    EXPECT_EQ(table.radiance(1), Rgb{});
    EXPECT_EQ(table.radiance(20), Rgb{});
}

TEST(MeshLight, ATableOfNothingGivesNothing)
{
    const EmitterTable table({});
    EXPECT_EQ(table.size(), 0U);
    EXPECT_FALSE(table.sample({}, {0.5, 0.5}, 0.5).wi);
    EXPECT_EQ(table.flux(), Rgb{});
    EXPECT_EQ(table.look(0, {}, normalize({0, 1, 0})).L, Rgb{});
}

TEST(MeshLight, TheEndsOfTheUnitIntervalPickTheFirstAndTheLast)
{
    const EmitterTable table(overhead());
    const Point3 p{0.1, 0.2, -0.3};
    EXPECT_EQ(table.sample(p, {0.5, 0.5}, 0.0).L, overhead()[1].L);  // primitive 2
    EXPECT_EQ(table.sample(p, {0.5, 0.5}, std::nextafter(1.0, 0.0)).L, overhead()[0].L);
}

}  // namespace
}  // namespace relight
