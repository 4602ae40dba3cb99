#pragma once

#include <span>
#include <vector>

#include "core/shade/kernels.h"
#include "core/transport/receiver.h"
#include "core/transport/transport.h"

namespace relight {

/// The radiance of blocks of vertices of one material, from columns, by the kernels.
class Shining {
  public:
    /// All outlive this. `first`: the vertex whose values the columns begin with; vertices are
    /// counted from it.
    Shining(const Stage& stage, const Transport& transport, const Scene& scene, std::size_t first);

    /// What each light that has a column brings, and which of the scene's it is.
    std::span<const kernel::Share> shares() const { return shares_; }
    const std::vector<std::size_t>& lights() const { return lights_; }

    const kernel::View& view() const { return view_; }

    /// block.rho of the vertices [begin, begin + count).
    void fill_rho(kernel::Block& block, const Material& material, std::size_t begin,
                  std::size_t count) const;
    /// And what else is known of them without their lights; L is what they send out by themselves.
    void fill(kernel::Block& block, const Material& material, const kernel::Reflector& reflector,
              std::size_t begin, std::size_t count) const;
    /// How `shares` light such vertices.
    kernel::Task task(const kernel::Reflector& reflector, std::span<const kernel::Share> shares,
                      float* radiance) const;

  private:
    Rgb own(const Material& material, std::size_t vertex) const;

    const Stage& stage_;
    const Scene& scene_;
    std::size_t first_;
    kernel::View view_;
    std::vector<kernel::Share> shares_;
    std::vector<std::size_t> lights_;
};

}  // namespace relight
