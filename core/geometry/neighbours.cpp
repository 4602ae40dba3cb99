#include "core/geometry/neighbours.h"

#include <array>
#include <limits>
#include <nanoflann.hpp>

#include "core/geometry/filled.h"

namespace relight {
namespace {

struct Stopped {};

/// nanoflann's view of our points while it builds its tree. It knows no other way to stop than an
/// exception.
struct Cloud {
    std::span<const Point3> points;
    const Progress& progress;

    std::size_t kdtree_get_point_count() const { return points.size(); }
    double kdtree_get_pt(std::size_t i, std::size_t axis) const
    {
        if (progress.stopped()) { throw Stopped{}; }
        const Point3 p = points[i];
        return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
    }
    template <class Box>
    bool kdtree_get_bbox(Box& /*box*/) const
    {
        return false;
    }
};

/// Its measure of distance: squared, straight from the points. Asked under its names, hence NOLINT.
struct Squared {
    using ElementType = double;
    using DistanceType = double;

    explicit Squared(const Cloud& cloud) : points(cloud.points) {}
    double evalMetric(const double* q, std::size_t i, std::size_t /*axes*/) const  // NOLINT
    {
        const Vec3 d = Point3{q[0], q[1], q[2]} - points[i];
        return dot(d, d);
    }
    double accum_dist(double a, double b, std::size_t /*axis*/) const  // NOLINT
    {
        return (a - b) * (a - b);
    }

    std::span<const Point3> points;
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<Squared, Cloud, 3, std::uint32_t>;

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

    // These too.
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

void find(std::span<const Point3> points, unsigned threads, Progress& progress, Neighbours& found)
{
    const Cloud cloud{points, progress};
    const Tree tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(16));
    // Points that the tree keeps together find the same neighbours: asked one after the other, they
    // find them in the processor's cache.
    parallel_for(points.size(), 4096, threads, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t at = begin; at < end; ++at) {
            const std::uint32_t self = tree.vAcc[at];
            const Point3 p = points[self];
            const std::array<double, 3> query{p.x, p.y, p.z};
            Nearest nearest(std::min(Neighbours::most + 1, points.size()));  // itself among them
            tree.findNeighbors(nearest, query.data(), nanoflann::SearchParams());
            const auto to = found.places(self);
            std::size_t kept = 0;
            for (const std::uint32_t i : nearest.indices()) {
                // Others in its very place may have crowded it out.
                if (i != self && kept < to.size()) { to[kept++] = i; }
            }
        }
    });
}

}  // namespace

Neighbours::Neighbours(std::size_t count, const Progress& progress)
    : indices_(filled(most * count, progress, none))
{
}

Neighbours neighbours_of(std::span<const Point3> points, unsigned threads, Progress& progress)
{
    Neighbours neighbours(points.size(), progress);
    if (points.size() < 2) { return neighbours; }
    try {
        find(points, threads, progress, neighbours);
    } catch (const Stopped&) {
        return neighbours;
    }
    return neighbours;
}

}  // namespace relight
