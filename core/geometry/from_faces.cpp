#include "core/geometry/from_faces.h"

#include <algorithm>
#include <mutex>
#include <numbers>
#include <utility>
#include <vector>

#include "core/geometry/filled.h"

namespace relight {
namespace {

static_assert(VertexRanges::block == TriangleBatch::size);

/// A sphere's worth of volume for a surface of this area is 1 (isoperimetric quotient); a room open
/// on one side or a scan with holes keeps most of it, a sheet has none.
constexpr double least_enclosed = 0.01;

constexpr std::size_t taken_at_once = 32'768;  // vertices

struct OfBlock {
    std::uint64_t degenerate = 0;
    double volume6 = 0.0, area2 = 0.0;
};

void load(std::span<const Point3> positions, std::span<const Triangle> triangles,
          TriangleBatch& batch)
{
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Point3 p = positions[triangles[i][k]];
            batch.corner[k][0][i] = p.x;
            batch.corner[k][1][i] = p.y;
            batch.corner[k][2][i] = p.z;
        }
    }
}

/// Sums of ranges done with, for the next: fresh memory for each would cost more than the sums.
class Spare {
  public:
    /// `count` of them, all unused; fewer if `progress` was stopped.
    std::vector<AtVertex> take(std::size_t count, const Progress& progress)
    {
        std::vector<AtVertex> sums;
        {
            const std::lock_guard lock(mutex_);
            if (!spare_.empty()) {
                sums = std::move(spare_.back());
                spare_.pop_back();
            }
        }
        if (sums.capacity() < count) { return filled<AtVertex>(count, progress); }
        sums.assign(count, {});
        return sums;
    }
    void give_back(std::vector<AtVertex>&& sums)
    {
        const std::lock_guard lock(mutex_);
        spare_.push_back(std::move(sums));
    }

  private:
    std::mutex mutex_;
    std::vector<std::vector<AtVertex>> spare_;
};

OfBlock total(const TriangleBatch& batch, std::size_t count)
{
    OfBlock sum;
    for (std::size_t i = 0; i < count; ++i) {
        sum.degenerate += batch.area2[i] == 0.0 ? 1 : 0;
        sum.volume6 += batch.volume6[i];
        sum.area2 += batch.area2[i];
    }
    return sum;
}

}  // namespace

OfFaces sum_faces(std::span<const Point3> positions, std::span<const Triangle> triangles,
                  Point3 centre, const VertexRanges& ranges, Progress& progress,
                  const std::function<void(std::size_t, std::span<const AtVertex>)>& take)
{
    constexpr std::size_t block = VertexRanges::block;
    std::vector<OfBlock> totals((triangles.size() + block - 1) / block);
    Spare spare;
    ranges.each([&](const VertexRanges::Range& range) {
        std::vector<AtVertex> sums = spare.take(range.size(), progress);
        TriangleBatch batch{};
        batch.centre = centre;
        for (const std::uint32_t b : range.blocks) {
            if (progress.stopped()) { return; }
            const std::size_t first = b * block;
            const auto some = triangles.subspan(first, std::min(block, triangles.size() - first));
            load(positions, some, batch);
            measure(batch);
            if (ranges.owns(range, b)) { totals[b] = total(batch, some.size()); }
            for (std::size_t i = 0; i < some.size(); ++i) {
                const Vec3 doubled_area{batch.doubled_area[0][i], batch.doubled_area[1][i],
                                        batch.doubled_area[2][i]};
                for (std::size_t k = 0; k < 3; ++k) {
                    if (!range.has(some[i][k])) { continue; }
                    AtVertex& sum = sums[some[i][k] - range.begin];
                    sum.normal += doubled_area * batch.weight[k][i];
                    sum.shortest2 = std::min(sum.shortest2, batch.shorter2[k][i]);
                }
            }
        }
        for (std::size_t v = 0; v < range.size() && !progress.stopped(); v += taken_at_once) {
            take(range.begin + v,
                 std::span(sums).subspan(v, std::min(taken_at_once, range.size() - v)));
        }
        spare.give_back(std::move(sums));
    });
    OfBlock sum;
    for (const OfBlock& one : totals) {
        sum.degenerate += one.degenerate;
        sum.volume6 += one.volume6;
        sum.area2 += one.area2;
    }
    // 36 pi V^2 / A^3 = 8 pi V6^2 / A2^3
    const double enclosed =
        8.0 * std::numbers::pi * sum.volume6 * sum.volume6 / (sum.area2 * sum.area2 * sum.area2);
    return {sum.degenerate, sum.volume6 < 0.0 && enclosed > least_enclosed};
}

}  // namespace relight
