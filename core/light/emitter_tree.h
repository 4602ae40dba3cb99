#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/light/mesh_light.h"

namespace relight {

/// Wider than what is inside by more than the rounding of where a ray enters and leaves; of nothing
/// what no ray meets.
EmitterBounds bounds_of(std::span<const Emitter> emitters);

/// Which of many triangles a ray meets first: a tree of boxes, eight to a node, halved at the
/// middle of their longest side, in double. Of those alone: others may stand before. Immutable.
class EmitterTree {
  public:
    explicit EmitterTree(std::span<const Emitter> emitters);

    /// The place of the nearest in what the tree was made of, of equals the first; nothing: none.
    std::optional<std::uint32_t> nearest(Point3 origin, Dir3 wi) const;

  private:
    static constexpr std::size_t width = 8;  ///< what vectors of any processor divide
    using Row = double[width];               // plain: g++ 12 makes vectors of nothing else
    struct Node {
        alignas(64) Row low[3], high[3];         ///< of those that are none no ray meets
        std::array<std::uint32_t, width> child;  ///< in nodes_, or is_leaf and one in leaves_
    };
    struct Leaf {
        alignas(64) Row corners[9];  ///< a.x, a.y, a.z, b.x ..; of those that are none all 0
        std::array<std::uint32_t, width> emitter;
    };
    static constexpr std::uint32_t is_leaf = 1U << 31U;

    std::uint32_t build(std::span<const Emitter> emitters, std::span<std::uint32_t> some);
    std::vector<Node> nodes_;  ///< the first is the root
    std::vector<Leaf> leaves_;
};

}  // namespace relight
