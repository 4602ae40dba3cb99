#include "core/light/emitter_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/base/vectors.h"

// CMakeLists.txt has this file optimised for vectors.

namespace relight {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
constexpr std::size_t most_waiting = 128;  // seven a level of 2^32 triangles, and more

constexpr std::array<double, 3> fields(Vec3 v)
{
    return {v.x, v.y, v.z};
}

/// Of what `each(use)` uses.
template <class Each>
EmitterBounds bounds(const Each& each)
{
    Vec3 low{infinite, infinite, infinite}, high{-infinite, -infinite, -infinite};
    each([&](const Emitter& emitter) {
        for (const Point3 p : emitter.corners) {
            low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
            high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
        }
    });
    if (!(low.x <= high.x)) { return {low, high}; }
    const auto size = [](Vec3 v) { return std::abs(v.x) + std::abs(v.y) + std::abs(v.z); };
    const double spare = 1e-14 * (size(low) + size(high));
    const Vec3 margin{spare, spare, spare};
    return {low - margin, high + margin};
}

EmitterBounds bounds_of(std::span<const Emitter> emitters, std::span<const std::uint32_t> some)
{
    return bounds([&](const auto& use) {
        for (const std::uint32_t e : some) { use(emitters[e]); }
    });
}

/// Distance along wi at which the triangle is met; infinite where it is not. Inside is as
/// look_at_triangle() has it.
inline double met_at(Vec3 a, Vec3 b, Vec3 c, Vec3 normal, Vec3 wi)
{
    const double volume = dot(a, normal), down = dot(wi, normal);
    const double side = std::copysign(1.0, volume);
    const double ab = side * dot(cross(a, b - a), wi), bc = side * dot(cross(b, c - b), wi),
                 ca = side * dot(cross(c, a - c), wi);
    const Mask is_met = where(side * down > 0.0) & where(ab >= 0.0) & where(bc >= 0.0) &
                        where(ca >= 0.0) & where(volume != 0.0);
    return choose(is_met, volume / choose(is_met, down, 1.0), infinite);
}

/// Halves at the middle of the longest side, and the halves again, while there are more than fit a
/// leaf.
void halve(std::span<const Emitter> emitters, std::span<std::uint32_t> some, std::size_t most,
           unsigned times, std::vector<std::span<std::uint32_t>>& parts)
{
    if (times == 0 || some.size() <= most) {
        parts.push_back(some);
        return;
    }
    const EmitterBounds box = bounds_of(emitters, some);
    const auto extent = fields(box.high - box.low);
    const auto axis =
        static_cast<std::size_t>(std::max_element(extent.begin(), extent.end()) - extent.begin());
    const auto centre = [&](std::uint32_t e) {
        double sum = 0.0;
        for (const Point3 p : emitters[e].corners) { sum += fields(p - Point3{})[axis]; }
        return sum;
    };
    const std::size_t middle = some.size() / 2;
    std::nth_element(some.begin(), some.begin() + static_cast<std::ptrdiff_t>(middle), some.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return centre(a) < centre(b); });
    halve(emitters, some.first(middle), most, times - 1, parts);
    halve(emitters, some.subspan(middle), most, times - 1, parts);
}

}  // namespace

EmitterBounds bounds_of(std::span<const Emitter> emitters)
{
    return bounds([&](const auto& use) { std::for_each(emitters.begin(), emitters.end(), use); });
}

EmitterTree::EmitterTree(std::span<const Emitter> emitters)
{
    std::vector<std::uint32_t> order(emitters.size());
    std::iota(order.begin(), order.end(), 0U);
    if (!order.empty()) { build(emitters, order); }
}

std::uint32_t EmitterTree::build(std::span<const Emitter> emitters, std::span<std::uint32_t> some)
{
    const auto own = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
    std::vector<std::span<std::uint32_t>> parts;
    halve(emitters, some, width, 3, parts);
    for (std::size_t k = 0; k < width; ++k) {
        const auto part = k < parts.size() ? parts[k] : std::span<std::uint32_t>{};
        const EmitterBounds box = bounds_of(emitters, part);
        const auto low = fields(box.low), high = fields(box.high);
        std::uint32_t child = 0;
        if (part.size() > width) {
            child = build(emitters, part);
        } else if (!part.empty()) {
            child = is_leaf | static_cast<std::uint32_t>(leaves_.size());
            Leaf& leaf = leaves_.emplace_back();
            for (std::size_t i = 0; i < part.size(); ++i) {
                leaf.emitter[i] = part[i];
                for (std::size_t c = 0; c < 9; ++c) {
                    leaf.corners[c][i] = fields(emitters[part[i]].corners[c / 3] - Point3{})[c % 3];
                }
            }
        }
        Node& node = nodes_[own];
        node.child[k] = child;
        for (std::size_t c = 0; c < 3; ++c) {
            node.low[c][k] = low[c];
            node.high[c][k] = high[c];
        }
    }
    return own;
}

std::optional<std::uint32_t> EmitterTree::nearest(Point3 origin, Dir3 wi) const
{
    if (nodes_.empty()) { return {}; }
    struct Waiting {
        double in;
        std::uint32_t node;
    };
    double nearest = infinite;
    std::optional<std::uint32_t> found;
    in_vectors([&] {
        const auto inverse = [](double along) {
            constexpr double least = 1e-200;  // not 0: 0 times its infinite inverse is no number
            return 1.0 / std::copysign(std::max(std::abs(along), least), along);
        };
        const Vec3 from = origin - Point3{}, along = wi;
        const Vec3 per{inverse(along.x), inverse(along.y), inverse(along.z)};
        std::array<Waiting, most_waiting> waiting;
        waiting[0] = {0.0, 0};
        std::size_t left = 1;
        while (left > 0) {
            const auto [first, next] = waiting[--left];
            if (first > nearest) { continue; }
            if ((next & is_leaf) != 0) {
                const Leaf& leaf = leaves_[next & ~is_leaf];
                const auto& c = leaf.corners;
                alignas(64) Row met;
                RELIGHT_APART
                for (std::size_t i = 0; i < width; ++i) {
                    const Vec3 A{c[0][i], c[1][i], c[2][i]}, B{c[3][i], c[4][i], c[5][i]},
                        C{c[6][i], c[7][i], c[8][i]};
                    met[i] = met_at(A - from, B - from, C - from, cross(B - A, C - A), along);
                }
                for (std::size_t i = 0; i < width; ++i) {
                    if (met[i] == infinite || met[i] > nearest) { continue; }
                    if (met[i] == nearest && found && *found < leaf.emitter[i]) { continue; }
                    nearest = met[i];
                    found = leaf.emitter[i];
                }
                continue;
            }
            const Node& node = nodes_[next];
            alignas(64) Row in, out;
            RELIGHT_APART
            for (std::size_t k = 0; k < width; ++k) {
                const double ax = (node.low[0][k] - from.x) * per.x;
                const double bx = (node.high[0][k] - from.x) * per.x;
                const double ay = (node.low[1][k] - from.y) * per.y;
                const double by = (node.high[1][k] - from.y) * per.y;
                const double az = (node.low[2][k] - from.z) * per.z;
                const double bz = (node.high[2][k] - from.z) * per.z;
                in[k] = std::max(std::max(0.0, std::min(ax, bx)),
                                 std::max(std::min(ay, by), std::min(az, bz)));
                out[k] = std::min(std::max(ax, bx), std::min(std::max(ay, by), std::max(az, bz)));
            }
            const std::size_t others = left;
            for (std::size_t k = 0; k < width; ++k) {
                if (!(in[k] <= out[k]) || in[k] > nearest || node.low[0][k] > node.high[0][k]) {
                    continue;
                }
                std::size_t at = left++;  // the nearest last
                for (; at > others && waiting[at - 1].in < in[k]; --at) {
                    waiting[at] = waiting[at - 1];
                }
                waiting[at] = {in[k], node.child[k]};
            }
        }
    });
    return found;
}

}  // namespace relight
