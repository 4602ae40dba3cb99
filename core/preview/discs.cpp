#include "core/preview/discs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace relight {
namespace {

constexpr std::size_t most_points = 200'000;
constexpr int corners = 6;
constexpr double height = 0.25;            // of the cone, in radii
constexpr double least_half_pixels = 1.5;  // half a disc's width is at least so many half pixels

}  // namespace

std::vector<std::uint32_t> chosen_points(std::size_t count)
{
    // Not always the same place of the run, which would leave stripes in a scan stored line by
    // line, but one scattered by a hash (the finaliser of MurmurHash3).
    const std::size_t kept = std::min(count, most_points);
    std::vector<std::uint32_t> chosen(kept);
    for (std::uint64_t i = 0; i < kept; ++i) {
        std::uint64_t hash = i + 1;
        hash = (hash ^ (hash >> 33U)) * 0xFF51AFD7ED558CCDULL;
        hash = (hash ^ (hash >> 33U)) * 0xC4CEB9FE1A85EC53ULL;
        const std::uint64_t begin = i * count / kept;
        const std::uint64_t end = (i + 1) * count / kept;
        chosen[i] = static_cast<std::uint32_t>(begin + (hash >> 33U) % (end - begin));
    }
    return chosen;
}

void add_disc(const DrawnPoint& point, Drawing& drawing)
{
    const Vec3 to_eye = drawing.eye - point.p;
    const Dir3 n = point.n ? point.n : normalize(to_eye);
    const double rise = dot(n, to_eye);
    if (rise < 0.0 && rise > -point.bend * length(to_eye)) { return; }
    const double depth = std::max(0.0, dot(to_eye, drawing.axes.back));
    const double half_pixel = depth * std::tan(0.5 * drawing.fov_y) / drawing.options.height;
    const double radius = std::max(point.radius, least_half_pixels * half_pixel);
    // Within the surface, so that it does not stand out over a silhouette: the tip lies on it where
    // the front is seen, the rim where the back is.
    const double tip = rise < 0.0 ? -height : 0.0;
    const double rim = rise < 0.0 ? 0.0 : -height;
    const Frame frame = frame_around(n);
    const auto first = static_cast<long long>(drawing.colors.size());
    const auto add = [&](Vec3 local) {
        const Point3 p = point.p + frame.to_world(local) * radius;
        for (const double x : {p.x, p.y, p.z}) {
            drawing.positions.push_back(static_cast<float>(x));
        }
        drawing.colors.push_back(point.color);
    };
    add({0.0, 0.0, tip});
    for (int k = 0; k < corners; ++k) {
        const double angle = 2.0 * std::numbers::pi * k / corners;
        add({std::cos(angle), std::sin(angle), rim});
        drawing.corners.insert(drawing.corners.end(),
                               {first, first + 1 + k, first + 1 + (k + 1) % corners});
    }
}

}  // namespace relight
