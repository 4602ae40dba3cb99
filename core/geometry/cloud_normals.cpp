#include "core/geometry/cloud_normals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/geometry/filled.h"
#include "core/geometry/sides.h"

namespace relight {
namespace {

constexpr std::size_t block = 4096;  // points

using Matrix3 = std::array<std::array<double, 3>, 3>;

/// One of Jacobi's rotations: a := R^T a R without a[p][q], v := v R.
void rotate(Matrix3& a, Matrix3& v, std::size_t p, std::size_t q)
{
    if (a[p][q] == 0.0) { return; }
    const double theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    const double t = std::copysign(1.0, theta) / (std::abs(theta) + std::sqrt(theta * theta + 1.0));
    const double c = 1.0 / std::sqrt(t * t + 1.0);
    const double s = t * c;
    const auto turn = [c, s](double& x, double& y) {
        const double before = x;
        x = c * before - s * y;
        y = s * before + c * y;
    };
    for (std::size_t k = 0; k < 3; ++k) { turn(a[k][p], a[k][q]); }
    for (std::size_t k = 0; k < 3; ++k) { turn(a[p][k], a[q][k]); }
    for (std::size_t k = 0; k < 3; ++k) { turn(v[k][p], v[k][q]); }
}

/// Direction in which a symmetric matrix of trace 1 is least. "No direction" where that is no
/// single one, or the second least is none either: what spread lies there is rounding.
Dir3 least_direction(Matrix3 a)
{
    constexpr int enough = 8;  // sweeps; convergence is quadratic
    constexpr double settled = 1e-17;
    constexpr double least_gap = 1e-8;  // of variances: a strip 1/10,000 as wide as long is a line
    Matrix3 v{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    for (int sweep = 0; sweep < enough; ++sweep) {
        if (std::abs(a[0][1]) + std::abs(a[0][2]) + std::abs(a[1][2]) < settled) { break; }
        rotate(a, v, 0, 1);
        rotate(a, v, 0, 2);
        rotate(a, v, 1, 2);
    }
    std::array<std::size_t, 3> order{0, 1, 2};
    std::sort(order.begin(), order.end(),
              [&](std::size_t i, std::size_t j) { return a[i][i] < a[j][j]; });
    const std::size_t least = order[0], second = order[1];
    if (!(a[second][second] - a[least][least] > least_gap)) { return {}; }
    return normalize({v[0][least], v[1][least], v[2][least]});
}

/// Direction of least spread of a point and its neighbours; either side.
Dir3 across(std::span<const Point3> points, std::size_t point,
            std::span<const std::uint32_t> neighbours)
{
    if (neighbours.size() < 2) { return {}; }
    const auto n = static_cast<double>(neighbours.size() + 1);
    Vec3 mean;  // relative to the point, so that nothing cancels far from the origin
    for (const std::uint32_t i : neighbours) { mean += (points[i] - points[point]) / n; }
    Matrix3 spread{};
    const auto add = [&](Vec3 from_mean) {
        const std::array<double, 3> d{from_mean.x, from_mean.y, from_mean.z};
        for (std::size_t r = 0; r < 3; ++r) {
            for (std::size_t c = 0; c < 3; ++c) { spread[r][c] += d[r] * d[c]; }
        }
    };
    add(-mean);
    for (const std::uint32_t i : neighbours) { add(points[i] - points[point] - mean); }
    const double trace = spread[0][0] + spread[1][1] + spread[2][2];
    if (!(trace > 0.0)) { return {}; }
    for (auto& row : spread) {
        for (double& entry : row) { entry /= trace; }
    }
    return least_direction(spread);
}

}  // namespace

std::vector<Dir3> estimate_normals(std::span<const Point3> points, const Neighbours& neighbours,
                                   std::span<const float> spacing,
                                   const std::optional<Point3>& toward, unsigned threads,
                                   Progress& progress)
{
    auto normals = filled<Dir3>(points.size(), progress);
    parallel_for(points.size(), block, threads, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            normals[i] = across(points, i, neighbours.of(i));
            if (toward && dot(*toward - points[i], normals[i]) < 0.0) { normals[i] = -normals[i]; }
        }
    });
    if (toward) { return normals; }
    choose_sides(points, neighbours, spacing, threads, progress, normals);
    return normals;
}

std::vector<float> cloud_bend(std::span<const Dir3> normals, const Neighbours& neighbours,
                              unsigned threads, Progress& progress)
{
    auto bend = filled<float>(normals.size(), progress);
    parallel_for(normals.size(), block, threads, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            double least = 1.0;  // cosine
            for (const std::uint32_t j : neighbours.of(i)) {
                if (normals[i] && normals[j]) {
                    least = std::min(least, dot(normals[i], normals[j]));
                }
            }
            constexpr double further = 2.0;
            const double angle = further * std::acos(std::clamp(least, 0.0, 1.0));
            bend[i] = static_cast<float>(std::sin(std::min(angle, 0.5 * std::numbers::pi)));
        }
    });
    return bend;
}

}  // namespace relight
