#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/vec.h"

namespace relight {

/// The nearest others of each point of a cloud, searched for once: spacing and normals both come
/// from them.
class Neighbours {
  public:
    static constexpr std::size_t most = 12;  ///< of a point: enough to average a scanner's noise
    static constexpr std::uint32_t none = ~0U;

    Neighbours() = default;
    /// Of `count` points, still without any.
    Neighbours(std::size_t count, const Progress& progress);

    std::size_t count() const { return indices_.size() / most; }

    /// Of a point, nearest first, as many as `most`: fewer in a smaller cloud.
    std::span<const std::uint32_t> of(std::size_t point) const
    {
        const std::uint32_t* first = indices_.data() + most * point;
        return {first, std::find(first, first + most, none)};
    }
    /// Where they are kept, `none` after the last.
    std::span<std::uint32_t, most> places(std::size_t point)
    {
        return std::span<std::uint32_t, most>(indices_.data() + most * point, most);
    }

  private:
    std::vector<std::uint32_t> indices_;
};

/// By a k-d tree, in n log n. The same points in the same order give the same answer, whatever the
/// threads; the nearer those stand that are near in space, the sooner. Of no use once `progress` is
/// stopped.
Neighbours neighbours_of(std::span<const Point3> points, unsigned threads, Progress& progress);

}  // namespace relight
