#include "core/geometry/spacing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/geometry/filled.h"

namespace relight {
namespace {

constexpr std::size_t counted = 8;          // neighbours
constexpr float most_of_neighbours = 3.0F;  // a corner of a square grid: 2

std::span<const std::uint32_t> nearest(const Neighbours& neighbours, std::size_t point)
{
    const auto all = neighbours.of(point);
    return all.first(std::min(counted, all.size()));
}

}  // namespace

std::vector<float> cloud_spacing(std::span<const Point3> points, const Neighbours& neighbours,
                                 unsigned threads, Progress& progress)
{
    constexpr std::size_t block = 4096;
    auto density = filled<float>(points.size(), progress);  // as the neighbours' number says
    parallel_for(points.size(), block, threads, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const auto near = nearest(neighbours, i);
            if (near.empty()) { continue; }
            const double per_area = std::numbers::pi / static_cast<double>(near.size());
            density[i] =
                static_cast<float>(length(points[near.back()] - points[i]) * std::sqrt(per_area));
        }
    });
    auto spacing = filled<float>(points.size(), progress);
    parallel_for(points.size(), block, threads, progress, [&](std::size_t begin, std::size_t end) {
        std::array<float, counted> around{};
        for (std::size_t i = begin; i < end; ++i) {
            const auto near = nearest(neighbours, i);
            if (near.empty()) { continue; }
            for (std::size_t k = 0; k < near.size(); ++k) { around[k] = density[near[k]]; }
            const auto middle = around.begin() + near.size() / 2;
            std::nth_element(around.begin(), middle, around.begin() + near.size());
            spacing[i] = std::min(density[i], most_of_neighbours * *middle);
        }
    });
    return spacing;
}

double expected_leak(double radius_scale)
{
    return std::exp(-std::numbers::pi * radius_scale * radius_scale);
}

}  // namespace relight
