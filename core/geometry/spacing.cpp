#include "core/geometry/spacing.h"

#include <algorithm>
#include <cmath>
#include <nanoflann.hpp>
#include <numbers>

namespace relight {
namespace {

/// nanoflann's view of our points.
struct Cloud {
    std::span<const Point3> points;
    std::size_t kdtree_get_point_count() const { return points.size(); }
    double kdtree_get_pt(std::size_t i, std::size_t axis) const
    {
        const Point3 p = points[i];
        return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
    }
    template <class Box>
    bool kdtree_get_bbox(Box& /*box*/) const
    {
        return false;
    }
};

constexpr std::size_t neighbours = 8;

}  // namespace

std::vector<float> cloud_spacing(std::span<const Point3> points, unsigned threads,
                                 Progress& progress)
{
    std::vector<float> spacing(points.size(), 0.0F);
    if (points.size() < 2) { return spacing; }
    const Cloud cloud{points};
    using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>,
                                                     Cloud, 3, std::size_t>;
    const Tree tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(16));
    const std::size_t wanted = std::min(neighbours + 1, points.size());  // itself is the first
    const double per_neighbours = std::sqrt(std::numbers::pi / static_cast<double>(wanted - 1));
    parallel_for(points.size(), 4096, threads, progress, [&](std::size_t begin, std::size_t end) {
        std::array<std::size_t, neighbours + 1> index{};
        std::array<double, neighbours + 1> squared{};
        for (std::size_t i = begin; i < end; ++i) {
            const std::array<double, 3> query{points[i].x, points[i].y, points[i].z};
            const std::size_t found =
                tree.knnSearch(query.data(), wanted, index.data(), squared.data());
            spacing[i] = static_cast<float>(std::sqrt(squared[found - 1]) * per_neighbours);
        }
    });
    return spacing;
}

}  // namespace relight
