#include "core/geometry/polygon.h"

#include <array>
#include <cmath>

namespace relight {
namespace {

struct Point2 {
    double x, y;
};

/// Twice the signed area of a, b, c.
double turn(Point2 a, Point2 b, Point2 c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// The polygon in the plane of its Newell normal, counter-clockwise, around its first corner.
std::vector<Point2> project(std::span<const Point3> positions, std::span<const unsigned> corners)
{
    Vec3 newell;
    const Point3 origin = positions[corners[0]];
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3 a = positions[corners[i]] - origin;
        const Vec3 b = positions[corners[(i + 1) % corners.size()]] - origin;
        newell += cross(a, b);
    }
    const Dir3 normal = normalize(newell);
    if (!normal) { return {}; }
    const Frame frame = frame_around(normal);
    std::vector<Point2> flat(corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3 local = frame.to_local(positions[corners[i]] - origin);
        flat[i] = {local.x, local.y};
    }
    return flat;
}

/// Every corner turns left and, together, once around: a fan is right.
bool is_convex(const std::vector<Point2>& p)
{
    const std::size_t n = p.size();
    double turned = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        const Point2 a = p[i];
        const Point2 b = p[(i + 1) % n];
        const Point2 c = p[(i + 2) % n];
        const double cross_product = turn(a, b, c);
        if (cross_product < 0.0) { return false; }
        const double along = (b.x - a.x) * (c.x - b.x) + (b.y - a.y) * (c.y - b.y);
        turned += std::atan2(cross_product, along);
    }
    return turned < 7.0;  // 2 pi; a pentagram turns 4 pi
}

bool is_ear(const std::vector<Point2>& p, const std::vector<std::size_t>& ring, std::size_t i)
{
    const std::size_t n = ring.size();
    const std::size_t before = ring[(i + n - 1) % n];
    const std::size_t here = ring[i];
    const std::size_t after = ring[(i + 1) % n];
    if (turn(p[before], p[here], p[after]) <= 0.0) { return false; }
    for (const std::size_t j : ring) {
        if (j == before || j == here || j == after) { continue; }
        if (turn(p[before], p[here], p[j]) >= 0.0 && turn(p[here], p[after], p[j]) >= 0.0 &&
            turn(p[after], p[before], p[j]) >= 0.0) {
            return false;
        }
    }
    return true;
}

void fan(std::span<const unsigned> corners, std::vector<Triangle>& triangles)
{
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
        triangles.push_back({corners[0], corners[i], corners[i + 1]});
    }
}

}  // namespace

bool triangulate(std::span<const Point3> positions, std::span<const unsigned> corners,
                 std::vector<Triangle>& triangles)
{
    if (corners.size() == 3) {
        triangles.push_back({corners[0], corners[1], corners[2]});
        return true;
    }
    const std::vector<Point2> flat = project(positions, corners);
    const bool whole = corners.size() <= most_corners_clipped;
    if (flat.empty() || is_convex(flat) || !whole) {
        fan(corners, triangles);
        return flat.empty() || whole || is_convex(flat);
    }
    std::vector<std::size_t> ring(corners.size());
    for (std::size_t i = 0; i < ring.size(); ++i) { ring[i] = i; }
    while (ring.size() > 3) {
        std::size_t ear = 0;
        while (ear < ring.size() && !is_ear(flat, ring, ear)) { ++ear; }
        if (ear == ring.size()) { ear = 0; }  // it crosses itself: any corner is as good
        const std::size_t n = ring.size();
        triangles.push_back(
            {corners[ring[(ear + n - 1) % n]], corners[ring[ear]], corners[ring[(ear + 1) % n]]});
        ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(ear));
    }
    triangles.push_back({corners[ring[0]], corners[ring[1]], corners[ring[2]]});
    return true;
}

}  // namespace relight
