#pragma once

#include <cstdint>
#include <memory>

#include "core/base/progress.h"
#include "core/trace/bvh.h"
#include "core/trace/occluders.h"

struct RTCSceneTy;  // Embree's scene: named, for no header of this room includes Embree

namespace relight {

/// Embree's tree over occluders, ready to be asked; none when its building was stopped.
using Tree = std::shared_ptr<RTCSceneTy>;

/// Ends at once when progress is stopped, even where Embree does not, unless mesh or surface of the
/// occluders are the caller's own. Hits are filtered by the context of who asks.
/// @param occluders live as long as the tree, or its building
Tree build_tree(const std::shared_ptr<const Occluders>& occluders, TreeQuality quality,
                Progress& progress);

/// Memory such a tree holds.
std::uint64_t tree_bytes(const Occluders& occluders, TreeQuality quality);

}  // namespace relight
