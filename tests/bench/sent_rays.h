#pragma once

#include <cstdint>
#include <vector>

#include "core/scene.h"
#include "tests/bench/raw_embree.h"

namespace relight::bench {

/// The very rays that trace() hands to Embree for a scene over a terrain or its cloud, in two
/// orders of their vertices (those of a lamp above it count as the nearest's below). Those of one
/// vertex stay in the order in which they were sent.
struct SentRays {
    std::vector<RawRay> by_mesh;    ///< vertices as filed
    std::vector<RawRay> by_morton;  ///< along Surface::order
    std::uint64_t blocked = 0;      ///< of them, as trace() found
    std::uint64_t told = 0;         ///< Transport::rays; other than there are: some went unseen
};

/// They are overheard: the linker puts a listener before Embree's rtcOccluded1, rtcOccluded1M and
/// rtcOccludedNp (--wrap in CMakeLists.txt), whatever room calls them.
/// @param grid vertices of the terrain, the first of the stage's
SentRays sent_rays(const Stage& stage, const RawEmbree& raw, const Scene& scene, std::size_t grid,
                   bool faces_y);

}  // namespace relight::bench
