#include "core/trace/extent.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>

#include "core/geometry/filled.h"

namespace relight {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::size_t lattice_slabs = 13;  // 26 directions, a slab holds two

}  // namespace

Extent::Extent(std::span<const Dir3> favoured)
{
    // The later half of {-1, 0, 1}^3 in order; the earlier mirrors it.
    for (int i = 14; i < 27; ++i) {
        const int x = i / 9 - 1, y = i / 3 % 3 - 1, z = i % 3 - 1;
        slabs_.push_back({Vec3{1.0 * x, 1.0 * y, 1.0 * z}, infinity, -infinity});
    }
    for (const Dir3 n : favoured) {
        if (!favour(n)) { break; }
    }
}

bool Extent::favour(Dir3 n)
{
    // Normals of one plane differ by roundings: a direction this close to one we have is that one.
    constexpr double same = 1e-12;
    const auto is_same = [&](const Slab& s) {
        return length(cross(s.along, n)) < same * length(s.along);
    };
    if (n && std::none_of(slabs_.rbegin(), slabs_.rend(), is_same)) {  // likely the last
        slabs_.push_back({n, infinity, -infinity});
    }
    return slabs_.size() < lattice_slabs + most_favoured;
}

void Extent::add(Vec3 place, double radius, Dir3 normal)
{
    for (Slab& s : slabs_) {
        const double at = dot(place, s.along);
        // A disc reaches r sin(angle between its normal and the direction) to either side.
        const double half = radius > 0.0 ? radius * length(cross(s.along, normal)) : 0.0;
        s.least = std::min(s.least, at - half);
        s.most = std::max(s.most, at + half);
    }
    radius_ = std::max(radius_, length(place) + radius);
}

double Extent::lattice_reach(int index) const
{
    const Slab& s = slabs_[static_cast<std::size_t>(std::abs(index) - 1)];
    return index > 0 ? s.most : -s.least;
}

double Extent::reach(Dir3 n) const
{
    if (radius_ < 0.0) { return -infinity; }
    // n = a axis + b edge + c corner, of lattice directions and with a, b, c >= 0: what reaches h_i
    // along each d_i reaches no more than a h_1 + b h_2 + c h_3 along n.
    struct Axis {
        double size;
        int step;  // from a lattice direction's index to that with this one added
    };
    const auto along = [](double x, int step) { return Axis{std::abs(x), x < 0.0 ? -step : step}; };
    // By choices: the order of a normal's coordinates cannot be foretold.
    const auto sort = [](Axis& more, Axis& less) {
        const bool swaps = more.size < less.size;
        const Axis first{std::max(more.size, less.size), swaps ? less.step : more.step};
        less = {std::min(more.size, less.size), swaps ? more.step : less.step};
        more = first;
    };
    Axis axis = along(n.x(), 9), edge = along(n.y(), 3), corner = along(n.z(), 1);
    sort(axis, edge);
    sort(edge, corner);
    sort(axis, edge);
    double bound = (axis.size - edge.size) * lattice_reach(axis.step) +
                   (edge.size - corner.size) * lattice_reach(axis.step + edge.step) +
                   corner.size * lattice_reach(axis.step + edge.step + corner.step);
    // dot(x, n) = dot(x, m) + dot(x, n - m)
    for (std::size_t k = lattice_slabs; k < slabs_.size(); ++k) {
        const Slab& s = slabs_[k];
        const auto tighten = [&](double reach, Vec3 apart) {
            // Most are far off: a root only for those that may be less.
            const double room = bound - reach;
            if (room > 0.0 && radius_ * radius_ * dot(apart, apart) < 1.001 * room * room) {
                bound = std::min(bound, reach + radius_ * length(apart));
            }
        };
        tighten(s.most, Vec3(n) - s.along);
        tighten(-s.least, Vec3(n) + s.along);
    }
    return bound;
}

void Extent::add(const Extent& other)
{
    for (std::size_t k = 0; k < slabs_.size(); ++k) {
        slabs_[k].least = std::min(slabs_[k].least, other.slabs_[k].least);
        slabs_[k].most = std::max(slabs_[k].most, other.slabs_[k].most);
    }
    radius_ = std::max(radius_, other.radius_);
}

Extent extent_of(const Mesh& mesh, const Surface& surface, Point3 centre, double point_radius_scale,
                 Progress& progress)
{
    constexpr std::size_t block = 1 << 13;  // places or triangles; milliseconds
    Extent nothing;
    for (std::size_t i = 0; i < surface.normals.size(); ++i) {
        if ((i % block == 0 && progress.stopped()) || !nothing.favour(surface.normals[i])) {
            break;
        }
    }
    const bool cloud = surface.triangles.empty();
    auto used = filled<std::uint8_t>(cloud ? 0 : mesh.positions.size(), progress);
    parallel_for(surface.triangles.size(), block, 0, progress,
                 [&](std::size_t begin, std::size_t end) {
                     for (std::size_t t = begin; t < end; ++t) {
                         for (const unsigned v : surface.triangles[t]) {
                             std::atomic_ref(used[v]).store(1, std::memory_order_relaxed);
                         }
                     }
                 });
    Extent whole = nothing;
    std::mutex joining;
    parallel_for(
        mesh.positions.size(), block, 0, progress, [&](std::size_t begin, std::size_t end) {
            Extent part = nothing;
            for (std::size_t i = begin; i < end; ++i) {
                const Vec3 place = mesh.positions[i] - centre;
                if (!cloud) {
                    if (used[i] != 0) { part.add(place); }
                    continue;
                }
                const double radius = point_radius_scale * static_cast<double>(surface.spacing[i]);
                if (!surface.normals[i] || !(radius > 0.0)) { continue; }  // no disc, no shadow
                part.add(place, radius, surface.normals[i]);
            }
            const std::lock_guard lock(joining);
            whole.add(part);
        });
    return whole;
}

}  // namespace relight
