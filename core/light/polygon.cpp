#include "core/light/polygon.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace relight {
namespace {

/// Gamma . n: the angle between a and b times the unit normal of their plane. The product is taken
/// with the edge: that of two long, nearly parallel vectors would lose its digits.
double contour(Vec3 a, Vec3 b, Dir3 n)
{
    const Vec3 normal = cross(a, b - a);
    const double sine = length(normal);
    return sine > 0.0 ? std::atan2(sine, dot(a, b)) * (dot(normal, n) / sine) : 0.0;
}

}  // namespace

double polygon_irradiance(std::span<const Point3> corners, Point3 p, Dir3 n)
{
    if (corners.size() < 3) { return 0.0; }
    Vec3 twice_area;
    double scale = 0.0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3 v = corners[i] - p;
        scale = std::max({scale, std::abs(v.x), std::abs(v.y), std::abs(v.z)});
        if (i >= 2) { twice_area += cross(corners[i - 1] - corners[0], corners[i] - corners[0]); }
    }
    if (!(dot(twice_area, p - corners[0]) > 0.0)) { return 0.0; }

    // Seen from p the corners run so that the sum is negative: no absolute value, which would make
    // light of rounding.
    double sum = 0.0;
    Vec3 exit, entry;  // where the contour dips below the horizon; both zero if it does not
    for (std::size_t i = 0; i < corners.size(); ++i) {
        Vec3 a = (corners[i] - p) / scale;
        Vec3 b = (corners[(i + 1) % corners.size()] - p) / scale;
        const double above_a = dot(a, n), above_b = dot(b, n);
        if (above_a <= 0.0 && above_b <= 0.0) { continue; }
        const Vec3 cut = a + (b - a) * (above_a / (above_a - above_b));
        if (above_a <= 0.0) { a = entry = cut; }
        if (above_b <= 0.0) { b = exit = cut; }
        sum += contour(a, b, n);
    }
    // The cut runs along the horizon: its normal is n, whatever rounding says.
    sum -= std::atan2(std::abs(dot(cross(exit, entry - exit), n)), dot(exit, entry));
    return std::clamp(-0.5 * sum, 0.0, std::numbers::pi);
}

}  // namespace relight
