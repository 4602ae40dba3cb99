#include "core/geometry/neighbours.h"

#include <array>
#include <limits>
#include <nanoflann.hpp>

namespace relight {
namespace {

/// nanoflann's view of those of our points that are there.
struct Cloud {
    std::span<const Point3> points;
    std::span<const std::uint32_t> present;  // empty: all
    std::size_t kdtree_get_point_count() const
    {
        return present.empty() ? points.size() : present.size();
    }
    std::uint32_t point(std::size_t i) const
    {
        return present.empty() ? static_cast<std::uint32_t>(i) : present[i];
    }
    double kdtree_get_pt(std::size_t i, std::size_t axis) const
    {
        const Point3 p = points[point(i)];
        return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
    }
    template <class Box>
    bool kdtree_get_bbox(Box& /*box*/) const
    {
        return false;
    }
};

using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud, double>, Cloud,
                                        3, std::uint32_t>;

/// The nearest of what nanoflann finds, nearest first. Unlike its own set, this one is content with
/// as many as it holds in the very place: a million copies of a point would be walked through for
/// each of them.
class Nearest {
  public:
    explicit Nearest(std::size_t wanted) : wanted_(wanted)
    {
        squared_.fill(std::numeric_limits<double>::infinity());
    }
    std::span<const std::uint32_t> indices() const { return std::span(index_).first(count_); }

    // Asked by nanoflann under its own names, hence NOLINT.
    bool full() const { return count_ == wanted_; }
    double worstDist() const { return squared_[wanted_ - 1]; }  // NOLINT
    /// Whether to go on.
    bool addPoint(double squared, std::uint32_t index)  // NOLINT
    {
        if (!(squared < worstDist())) { return true; }  // it asks by what was worst a while ago
        count_ = std::min(count_ + 1, wanted_);
        std::size_t at = count_ - 1;
        for (; at > 0 && squared_[at - 1] > squared; --at) {
            squared_[at] = squared_[at - 1];
            index_[at] = index_[at - 1];
        }
        squared_[at] = squared;
        index_[at] = index;
        return worstDist() > 0.0;
    }

  private:
    std::size_t wanted_, count_ = 0;
    std::array<double, Neighbours::most + 1> squared_{};
    std::array<std::uint32_t, Neighbours::most + 1> index_{};
};

std::vector<std::uint32_t> without(std::size_t count, std::span<const std::uint32_t> absent)
{
    std::vector<std::uint32_t> present;
    present.reserve(count - absent.size());
    for (std::uint32_t i = 0; i < count; ++i) {
        if (!absent.empty() && absent.front() == i) {
            absent = absent.subspan(1);
        } else {
            present.push_back(i);
        }
    }
    return present;
}

}  // namespace

Neighbours neighbours_of(std::span<const Point3> points, std::span<const std::uint32_t> absent,
                         unsigned threads, Progress& progress)
{
    Neighbours neighbours(points.size());
    if (points.size() < absent.size() + 2) { return neighbours; }
    const std::vector<std::uint32_t> present =
        absent.empty() ? std::vector<std::uint32_t>() : without(points.size(), absent);
    const Cloud cloud{points, present};
    const Tree tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(16));
    const std::size_t count = cloud.kdtree_get_point_count();
    // Points that the tree keeps together find the same neighbours: asked one after the other, they
    // find them in the processor's cache, whatever the order of the file.
    parallel_for(count, 4096, threads, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t at = begin; at < end; ++at) {
            const std::uint32_t self = tree.vAcc[at];
            const Point3 p = points[cloud.point(self)];
            const std::array<double, 3> query{p.x, p.y, p.z};
            Nearest found(std::min(Neighbours::most + 1, count));  // itself among them
            tree.findNeighbors(found, query.data(), nanoflann::SearchParams());
            const auto to = neighbours.places(cloud.point(self));
            std::size_t kept = 0;
            for (const std::uint32_t i : found.indices()) {
                // Others in its very place may have crowded it out.
                if (i != self && kept < to.size()) { to[kept++] = cloud.point(i); }
            }
        }
    });
    return neighbours;
}

}  // namespace relight
