#include "core/light/cap.h"
#include "core/light/polygon.h"
#include "tests/light/area_checks.h"

namespace relight {
namespace {

using std::numbers::pi;
using test::Numbers;

/// E of a cap by integrating cos over it: rings about the axis, the visible part of each in closed
/// form. Gauss-Legendre of 3 points in many panels, substituted so that both ends are smooth.
double cap_by_rings(double half_angle, double beta)
{
    const auto ring = [&](double a) {  // integral over phi of (cos a cos b + sin a sin b cos phi)+
        const double c = std::cos(a) * std::cos(beta), s = std::sin(a) * std::sin(beta);
        if (c >= s) { return 2.0 * pi * c; }
        if (c <= -s) { return 0.0; }
        const double end = std::acos(-c / s);
        return 2.0 * (c * end + s * std::sin(end));
    };
    constexpr double x[] = {-0.7745966692414834, 0.0, 0.7745966692414834};
    constexpr double w[] = {5.0 / 9, 8.0 / 9, 5.0 / 9};
    constexpr int panels = 4000;
    double sum = 0.0;
    for (int i = 0; i < panels; ++i) {
        for (int k = 0; k < 3; ++k) {
            const double a = half_angle * (i + 0.5 + 0.5 * x[k]) / panels;
            sum += w[k] * ring(a) * std::sin(a);
        }
    }
    return sum * 0.5 * half_angle / panels;
}

TEST(Cap, IsTheIntegralOfTheCosineOverItsVisiblePart)
{
    for (const double half_angle : {0.004651, 0.1, 0.7, 1.3, pi / 2}) {
        for (int i = 0; i < 37; ++i) {
            const double beta = pi * i / 37.0;
            const double exact = cap_by_rings(half_angle, beta);
            EXPECT_NEAR(cap_irradiance(std::sin(half_angle), std::cos(beta)), exact,
                        1e-7 * exact + 1e-14)
                << half_angle << ", " << beta;
        }
    }
}

TEST(Cap, IsContinuousWhereTheHorizonBeginsToCut)
{
    for (const double s : {1e-6, 1e-3, 0.1, 0.5, 0.9, 0.999999}) {
        for (const double edge : {s, -s}) {
            const double below = cap_irradiance(s, std::nextafter(edge, -1.0));
            const double above = cap_irradiance(s, std::nextafter(edge, 1.0));
            EXPECT_NEAR(below, above, 1e-9 * s * s) << s << " at " << edge;
        }
        for (const double step : {1e-3, 1e-6, 1e-9}) {  // it leaves the branch smoothly
            EXPECT_NEAR(cap_irradiance(s, s * (1.0 - step)), pi * s * s * s,
                        4.0 * s * s * s * step);
            EXPECT_NEAR(cap_irradiance(s, -s * (1.0 - step)), 0.0, 4.0 * s * s * s * step);
        }
    }
}

TEST(Cap, KeepsItsDigitsWhenNarrow)
{
    // On the horizon half of it is seen: to first order the integral of y over half a disk.
    for (const double s : {1e-3, 1e-5, 1e-8, 1e-20}) {
        EXPECT_NEAR(cap_irradiance(s, 0.0) / (s * s * s), 2.0 / 3.0, s * s + 1e-11);
    }
    EXPECT_EQ(cap_irradiance(0.0, 0.5), 0.0);
}

TEST(SphereLight, AboveTheHorizonIsAPointLightAtAnyDistance)  // I = pi R^2 L
{
    for (std::uint64_t item = 0; item < 500; ++item) {
        Numbers random(item);
        const SphereLight sphere = test::some_sphere(random);
        const double d = sphere.radius * (1.0 + random.scale(1e-9, 1e6));
        const Dir3 away = random.direction();
        const Point3 p = sphere.center + Vec3(away) * d;
        const Dir3 n = normalize(-Vec3(away) + random.vector(0.9));
        if (dot(n, -away) < sphere.radius / d * (1.0 + 1e-9)) { continue; }
        const double I = pi * sphere.radius * sphere.radius;
        const double exact =
            irradiance(PointLight{sphere.center, {}}, {Rgb::grey(I)}, p, n).value.g;
        EXPECT_NEAR(irradiance(sphere, p, n), exact, 1e-7 * exact);
    }
}

TEST(SphereLight, FillsTheHemisphereOfAReceiverThatTouchesIt)
{
    const SphereLight sphere{{1, 2, 3}, 0.5};
    const Dir3 away = normalize({1, -1, 0.5});
    for (const double gap : {1e-6, 1e-9, 1e-12}) {
        const Point3 p = sphere.center + Vec3(away) * (0.5 * (1.0 + gap));
        EXPECT_NEAR(irradiance(sphere, p, -away), pi, 1e-5);
        EXPECT_NEAR(irradiance(sphere, p, frame_around(away).x), pi / 2, 1e-2);
    }
    const Point3 inside = sphere.center + Vec3(away) * 0.4;
    EXPECT_EQ(irradiance(sphere, inside, -away), 0.0);  // it shines outward
    EXPECT_FALSE(sample(sphere, inside, {0.5, 0.5}).wi);
    EXPECT_FALSE(look(sphere, inside, away).wi);
}

TEST(SphereLight, IsTheCapThatItCovers)
{
    for (std::uint64_t item = 0; item < 200; ++item) {
        Numbers random(item);
        const double half_angle = random.between(0.01, 1.5);
        const DirectionalLight sun{random.direction(), half_angle};
        const Dir3 n = random.direction();
        const SphereLight sphere{Point3{} - Vec3(sun.travel) * 2.0, 2.0 * std::sin(half_angle)};
        const double L = look(sun, -sun.travel).L.g;
        EXPECT_NEAR(L * irradiance(sphere, {}, n), irradiance(sun, n), 1e-12);
    }
}

TEST(Sun, GivesItsPowerToWhatFacesIt)
{
    for (const double half_angle : {0.0, 1e-80, 1e-12, 0.004651, 0.5, pi / 2}) {
        const DirectionalLight sun{normalize({0.3, -2, 1}), half_angle};
        EXPECT_NEAR(irradiance(sun, -sun.travel), 1.0, 1e-14) << half_angle;
        EXPECT_EQ(irradiance(sun, sun.travel), 0.0);
    }
}

TEST(Sun, WithoutADiscIsTheLimitOfNarrowOnes)
{
    Numbers random(1);
    for (int i = 0; i < 100; ++i) {
        const Dir3 travel = random.direction(), n = random.direction();
        EXPECT_NEAR(irradiance(DirectionalLight{travel, 1e-7}, n), irradiance({travel}, n), 1e-7);
    }
}

/// The disk as a polygon of many corners with the same area: equal to second order.
std::vector<Point3> outline(const DiskLight& disk, int corners)
{
    const Frame frame = frame_around(disk.normal);
    const double turn = 2.0 * pi / corners;
    const double R = disk.radius * std::sqrt(turn / std::sin(turn));
    std::vector<Point3> at;
    at.reserve(static_cast<std::size_t>(corners));
    for (int i = 0; i < corners; ++i) {
        at.push_back(disk.center +
                     frame.to_world({R * std::cos(i * turn), R * std::sin(i * turn), 0.0}));
    }
    return at;
}

TEST(DiskLight, IsAPolygonOfManyCorners)  // wholly above the horizon, cut and near alike
{
    constexpr int corners = 2000;
    int cut = 0;
    for (std::uint64_t item = 0; item < 300; ++item) {
        Numbers random(item);
        const DiskLight disk = test::some_disk(random);
        const Frame frame = frame_around(disk.normal);
        const double rho = disk.radius * random.scale(1e-9, 10.0);
        const double h = disk.radius * random.scale(0.05, 10.0), phi = random.between(0.0, 2 * pi);
        const Point3 p =
            disk.center + frame.to_world({rho * std::cos(phi), rho * std::sin(phi), h});
        const Vec3 to_center = disk.center - p;
        // Every other normal looks past the disk, so that the horizon cuts it.
        const Dir3 n = item % 2 == 0 ? random.direction()
                                     : normalize(cross(to_center, random.direction()) +
                                                 to_center * random.between(-0.3, 0.3));
        const double exact = polygon_irradiance(outline(disk, corners), p, n);
        EXPECT_NEAR(irradiance(disk, p, n), exact, 3e-6 * exact + 1e-7 * disk.radius / h) << item;
        const double above = dot(n, to_center);
        const double reach = disk.radius * length(cross(n, disk.normal));
        cut += std::abs(above) < reach ? 1 : 0;
    }
    EXPECT_GT(cut, 100);
}

TEST(DiskLight, OnItsAxisFacingHasTheTextbookValue)  // pi R^2 / (R^2 + h^2)
{
    for (const double h : {1e-12, 1e-6, 0.01, 1.0, 100.0, 1e9}) {
        const DiskLight disk{{1, 2, 3}, normalize({1, 1, -2}), 0.7};
        const double R2 = 0.49;
        const Point3 p = disk.center + Vec3(disk.normal) * h;
        const double exact = pi * R2 / (R2 + h * h);
        EXPECT_NEAR(irradiance(disk, p, -disk.normal), exact, 1e-8 * exact) << h;
        EXPECT_EQ(irradiance(disk, p, disk.normal), 0.0);
        EXPECT_EQ(irradiance(disk, disk.center - Vec3(disk.normal) * h, disk.normal), 0.0);
    }
}

TEST(DiskLight, IsContinuousWhereTheHorizonBeginsToCut)
{
    for (std::uint64_t item = 0; item < 300; ++item) {
        Numbers random(item);
        const DiskLight disk{{}, normalize({0, 0, 1}), 1.0};
        const Point3 p{random.between(-3, 3), random.between(-3, 3), random.scale(0.01, 10.0)};
        // The horizon touches the rim at m: n is perpendicular to p - m and to the rim there.
        const double phi = random.between(0.0, 2.0 * pi);
        const Vec3 tangent{-std::sin(phi), std::cos(phi), 0.0};
        const Vec3 to_rim = Point3{std::cos(phi), std::sin(phi), 0.0} - p;
        const Vec3 touching = normalize(cross(to_rim, tangent));
        for (const double side : {-1.0, 1.0}) {
            const double step = 1e-7;
            const double one = irradiance(disk, p, normalize(touching * side + to_rim * step));
            const double other = irradiance(disk, p, normalize(touching * side - to_rim * step));
            EXPECT_NEAR(one, other, 20.0 * step * length(to_rim));
        }
    }
}

TEST(AreaLights, OfFixedRadianceKnowNoScale)
{
    for (std::uint64_t item = 0; item < 300; ++item) {
        Numbers random(item);
        const RectLight rect = test::some_rect(random);
        const DiskLight disk = test::some_disk(random);
        const SphereLight sphere = test::some_sphere(random);
        const Vec3 p = random.vector(3.0);
        const Dir3 n = random.direction();
        const double k = random.scale(1e-6, 1e6);
        const auto scaled = [&](Point3 q) { return Point3{} + (q - Point3{}) * k; };
        const Point3 near = Point3{} + p, far = scaled(near);
        EXPECT_NEAR(
            irradiance(RectLight{scaled(rect.center), rect.edge_u * k, rect.edge_v * k}, far, n),
            irradiance(RectLight{rect.center, rect.edge_u, rect.edge_v}, near, n), 1e-10);
        EXPECT_NEAR(
            irradiance(DiskLight{scaled(disk.center), disk.normal, disk.radius * k}, far, n),
            irradiance(disk, near, n), 1e-10);
        EXPECT_NEAR(irradiance(SphereLight{scaled(sphere.center), sphere.radius * k}, far, n),
                    irradiance(sphere, near, n), 1e-10);
    }
}

}  // namespace
}  // namespace relight
