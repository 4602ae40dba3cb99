#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/vectors.h"
#include "core/light/polygon.h"
#include "core/light/rect_light.h"
#include "core/light/triangle_lanes.h"

// CMakeLists.txt has this file optimised for vectors.

namespace relight {
namespace {

constexpr std::size_t many = 64;  // places at once
// Plain arrays: g++ 12 makes no vectors of what it reads from a const std::array.
using Lane = double[many];

/// The rectangle from a place.
struct Corners {
    std::array<Vec3, 4> at;
    double volume;  ///< of the centre and the normal: < 0 in front
};
inline Corners corners(const RectLight& light, Vec3 normal, Vec3 to_center)
{
    const Vec3 u = light.edge_u * 0.5, v = light.edge_v * 0.5;
    const std::array<Vec3, 4> at{to_center - u - v, to_center + u - v, to_center + u + v,
                                 to_center - u + v};
    return {at, dot(to_center, normal)};
}

inline double largest(Vec3 v)
{
    return std::max(std::abs(v.x), std::max(std::abs(v.y), std::abs(v.z)));
}

/// polygon_irradiance() of the rectangle, its branches turned into choices.
inline double lane_irradiance(const RectLight& light, Vec3 normal, Vec3 to_center, Vec3 n)
{
    const Corners seen = corners(light, normal, to_center);
    const double scale = std::max(std::max(largest(seen.at[0]), largest(seen.at[1])),
                                  std::max(largest(seen.at[2]), largest(seen.at[3])));
    const double per_scale = 1.0 / choose(where(scale > 0.0), scale, 1.0);
    double contour = 0.0;
    Vec3 exit, entry;
    const auto edge = [&](Vec3 begin, Vec3 end) {
        const Vec3 a = begin * per_scale, b = end * per_scale;
        const double above_a = dot(a, n), above_b = dot(b, n);
        const Mask from_below = where(!(above_a > 0.0)), to_below = where(!(above_b > 0.0));
        const double apart = above_a - above_b;
        const Vec3 cut = a + (b - a) * (above_a / choose(where(apart != 0.0), apart, 1.0));
        const Mask rises = from_below & ~to_below, falls = ~from_below & to_below;
        entry = choose(rises, cut, entry);
        exit = choose(falls, cut, exit);
        const Vec3 from = choose(rises, cut, a), to = choose(falls, cut, b);
        const Vec3 across = cross(from, to - from);
        const double sine = std::sqrt(dot(across, across));
        const double angle = warp::angle_above(sine, dot(from, to));
        const double part = angle * (dot(across, n) / choose(where(sine > 0.0), sine, 1.0));
        contour += choose(from_below & to_below, 0.0, part);
    };
    edge(seen.at[0], seen.at[1]);
    edge(seen.at[1], seen.at[2]);
    edge(seen.at[2], seen.at[3]);
    edge(seen.at[3], seen.at[0]);
    const double closing =
        warp::angle_above(std::abs(dot(cross(exit, entry - exit), n)), dot(exit, entry));
    const Mask is_behind = where(seen.volume > 0.0);
    const Mask shines = where(seen.volume < 0.0) | (where(light.two_sided) & is_behind);
    const double E = -0.5 * (choose(is_behind, -contour, contour) - closing);
    return choose(shines & where(E > 0.0), std::min(E, std::numbers::pi), 0.0);
}

inline RectDirections lane_directions(const RectLight& light, Vec3 normal, double least_volume2,
                                      Vec3 to_center)
{
    const Corners seen = corners(light, normal, to_center);
    const auto& at = seen.at;
    const auto of_each = [](const auto& from,
                            const auto& make) -> std::array<decltype(make(from[0])), 4> {
        return {make(from[0]), make(from[1]), make(from[2]), make(from[3])};
    };
    const auto squared = of_each(at, [](Vec3 corner) { return dot(corner, corner); });
    const auto distance = of_each(squared, [](double d2) { return std::sqrt(d2); });
    const auto per = of_each(distance, [](double d) { return 1.0 / d; });
    const std::array<Vec3, 4> unit{at[0] * per[0], at[1] * per[1], at[2] * per[2], at[3] * per[3]};
    const double far2 =
        std::max(std::max(squared[0], squared[1]), std::max(squared[2], squared[3]));
    const double near2 =
        std::min(std::min(squared[0], squared[1]), std::min(squared[2], squared[3]));
    RectDirections there;
    there.halves[0] = lanes::spherical(unit[0], unit[1], unit[2],
                                       lanes::solid_angle(at[0], at[1], at[2], distance[0],
                                                          distance[1], distance[2], seen.volume));
    there.halves[1] = lanes::spherical(unit[0], unit[2], unit[3],
                                       lanes::solid_angle(at[0], at[2], at[3], distance[0],
                                                          distance[2], distance[3], seen.volume));
    there.normal = normal;
    there.height = std::abs(seen.volume);
    there.farthest = std::sqrt(far2);
    const Mask shines = where(seen.volume < 0.0) | where(light.two_sided);
    const double least = std::min(there.halves[0].solid_angle, there.halves[1].solid_angle);
    const Vec3 T = there.halves[0].T + there.halves[1].T;
    const Mask is_usual = where(seen.volume * seen.volume > least_volume2) & where(near2 > 1e-60) &
                          where(far2 < 1e60) & where(least > 2.0 * least_solid_angle) &
                          where(dot(T, T) < 5.0);  // they are numbers
    const double both = there.halves[0].solid_angle + there.halves[1].solid_angle;
    there.whole = choose(is_usual, choose(shines, both, 0.0), -1.0);
    return there;
}

constexpr std::size_t numbers = 29;  // of RectDirections, but for the normal

}  // namespace

void irradiance(const RectLight& light, std::span<const Point3> p, std::span<const Dir3> n,
                std::span<double> E)
{
    const Vec3 normal = cross(light.edge_u, light.edge_v);
    for (std::size_t first = 0; first < p.size(); first += many) {
        const std::size_t count = std::min(many, p.size() - first);
        alignas(64) Lane x{}, y{}, z{}, nx{}, ny{}, nz{}, sum{};
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3 d = light.center - p[first + i];
            x[i] = d.x, y[i] = d.y, z[i] = d.z;
            const Vec3 up = n[first + i];
            nx[i] = up.x, ny[i] = up.y, nz[i] = up.z;
        }
        in_vectors([&] {
            const RectLight here = light;
            const Vec3 up = normal;
            RELIGHT_APART
            for (std::size_t i = 0; i < many; ++i) {
                sum[i] = lane_irradiance(here, up, {x[i], y[i], z[i]}, {nx[i], ny[i], nz[i]});
            }
        });
        std::copy_n(sum, count, E.begin() + static_cast<std::ptrdiff_t>(first));
    }
}

void directions(const RectLight& light, std::span<const Point3> p, std::span<RectDirections> seen)
{
    const Vec3 u = light.edge_u, v = light.edge_v;
    const Vec3 normal = cross(u, v);
    const double longest2 = std::max(dot(u + v, u + v), std::max(dot(u, u), dot(v, v)));
    const double least_volume2 = 4.0 * least_height * least_height * longest2 * dot(normal, normal);
    for (std::size_t first = 0; first < p.size(); first += many) {
        const std::size_t count = std::min(many, p.size() - first);
        alignas(64) Lane x{}, y{}, z{};
        alignas(64) Lane rows[numbers];
        for (std::size_t i = 0; i < count; ++i) {
            const Vec3 d = light.center - p[first + i];
            x[i] = d.x, y[i] = d.y, z[i] = d.z;
        }
        in_vectors([&] {
            const RectLight here = light;
            const Vec3 up = normal;
            const double least = least_volume2;
            RELIGHT_APART
            for (std::size_t i = 0; i < many; ++i) {
                const RectDirections there = lane_directions(here, up, least, {x[i], y[i], z[i]});
                const auto put = [&](std::size_t row, const SphericalTriangle& half) {
                    rows[row][i] = half.solid_angle;
                    rows[row + 1][i] = half.A.x;
                    rows[row + 2][i] = half.A.y;
                    rows[row + 3][i] = half.A.z;
                    rows[row + 4][i] = half.B.x;
                    rows[row + 5][i] = half.B.y;
                    rows[row + 6][i] = half.B.z;
                    rows[row + 7][i] = half.T.x;
                    rows[row + 8][i] = half.T.y;
                    rows[row + 9][i] = half.T.z;
                    rows[row + 10][i] = half.sum;
                    rows[row + 11][i] = half.sine;
                    rows[row + 12][i] = half.b_dot_t;
                };
                put(0, there.halves[0]);
                put(13, there.halves[1]);
                rows[26][i] = there.whole;
                rows[27][i] = there.height;
                rows[28][i] = there.farthest;
            }
        });
        for (std::size_t i = 0; i < count; ++i) {
            RectDirections& to = seen[first + i];
            for (std::size_t h = 0; h < 2; ++h) {
                const auto at = [&](std::size_t row) { return rows[13 * h + row][i]; };
                SphericalTriangle& half = to.halves[h];
                half.solid_angle = at(0);
                half.A = {at(1), at(2), at(3)};
                half.B = {at(4), at(5), at(6)};
                half.T = {at(7), at(8), at(9)};
                half.sum = at(10);
                half.sine = at(11);
                half.b_dot_t = at(12);
            }
            to.whole = rows[26][i];
            to.normal = normal;
            to.height = rows[27][i];
            to.farthest = rows[28][i];
        }
    }
}

}  // namespace relight
