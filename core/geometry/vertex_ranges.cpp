#include "core/geometry/vertex_ranges.h"

#include <algorithm>
#include <array>
#include <thread>

namespace relight {
namespace {

constexpr std::size_t at_home = 32'768;   // vertices: with 32 bytes each they fit into the L2 cache
constexpr std::size_t most_ranges = 256;  // each looks at every block's least and most
constexpr std::size_t few = 2048;         // vertices: not worth a thread
constexpr double disorder = 2.0;          // ranges that a block touches, in the mean

}  // namespace

VertexRanges::Touched VertexRanges::touched_by(std::span<const Triangle> triangles)
{
    std::array<unsigned, 3> least{triangles[0]}, most{least};  // by corner: three chains, not one
    for (const Triangle& t : triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            least[k] = std::min(least[k], t[k]);
            most[k] = std::max(most[k], t[k]);
        }
    }
    return {std::min({least[0], least[1], least[2]}), std::max({most[0], most[1], most[2]})};
}

VertexRanges::VertexRanges(std::span<const Triangle> triangles, std::size_t vertices,
                           unsigned threads, Progress& progress)
    : touched_((triangles.size() + block - 1) / block),
      vertices_(vertices),
      threads_(threads == 0 ? std::max(1U, std::thread::hardware_concurrency()) : threads),
      progress_(progress)
{
    constexpr std::size_t blocks_at_once = 512;
    parallel_for(touched_.size(), blocks_at_once, threads, progress,
                 [&](std::size_t begin, std::size_t end) {
                     for (std::size_t b = begin; b < end; ++b) {
                         const std::size_t first = b * block;
                         touched_[b] = touched_by(
                             triangles.subspan(first, std::min(block, triangles.size() - first)));
                     }
                 });
    const auto length_of = [&](std::size_t a_thread) {  // so many ranges a thread, all alike
        return std::max(few, vertices / (a_thread * threads_) + 1);
    };
    const std::size_t ranges = std::min(most_ranges, vertices / at_home + 1);
    length_ = length_of((ranges + threads_ - 1) / threads_);
    std::size_t looks = 0;
    for (const Touched t : touched_) { looks += t.most / length_ - t.least / length_ + 1; }
    if (static_cast<double>(looks) > disorder * static_cast<double>(touched_.size())) {
        length_ = length_of(1);
    }
}

void VertexRanges::each(const std::function<void(const Range&)>& body) const
{
    parallel_for(vertices_, length_, threads_, progress_, [&](std::size_t begin, std::size_t end) {
        std::vector<std::uint32_t> blocks;
        for (std::size_t b = 0; b < touched_.size(); ++b) {
            if (touched_[b].least < end && touched_[b].most >= begin) {
                blocks.push_back(static_cast<std::uint32_t>(b));
            }
        }
        body({begin, end, blocks});
    });
}

}  // namespace relight
