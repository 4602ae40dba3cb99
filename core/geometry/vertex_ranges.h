#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/vec.h"

namespace relight {

/// Sums over the triangles at each vertex, on many threads and in the triangles' order: each thread
/// takes a range of vertices and looks at the triangles that touch it, a block of them at once. So
/// a sum has the same bytes for any number of threads, and needs no locks.
class VertexRanges {
  public:
    static constexpr std::size_t block = 128;  ///< triangles

    struct Range {
        std::size_t begin, end;                 ///< vertices
        std::span<const std::uint32_t> blocks;  ///< that touch them: block b begins at b * block

        std::size_t size() const { return end - begin; }
        bool has(std::size_t vertex) const { return vertex - begin < size(); }
    };

    /// Of a mesh whose neighbours in the file are neighbours in space, ranges fit into the cache.
    /// Of one in disorder most blocks touch most ranges: then there is one a thread.
    VertexRanges(std::span<const Triangle> triangles, std::size_t vertices, unsigned threads,
                 Progress& progress);

    /// Calls body(range) for all ranges: each vertex is in one. A body that looks at many blocks
    /// asks `progress` now and then.
    void each(const std::function<void(const Range&)>& body) const;

    /// Whether it is this range's business to sum up block b as such: of no other range it is.
    bool owns(const Range& range, std::size_t b) const { return range.has(touched_[b].least); }

  private:
    struct Touched {
        std::uint32_t least, most;  ///< vertex
    };
    static Touched touched_by(std::span<const Triangle> triangles);

    std::vector<Touched> touched_;  ///< by blocks
    std::size_t vertices_, length_ = 1;
    unsigned threads_;
    Progress& progress_;
};

}  // namespace relight
