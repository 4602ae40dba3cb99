#pragma once

#include <vector>

#include "core/shade/kernels.h"
#include "core/transport/receiver.h"
#include "core/transport/transport.h"

namespace relight {

/// The radiance of blocks of vertices of one material, from columns, by the kernels.
class Shining {
  public:
    /// What a light brings.
    struct Part {
        std::size_t light;  ///< in the scene
        const Column* column;
        const float* Lo;  ///< null: nothing was drawn
        bool delta;
        double power[3];
        kernel::Source source;  ///< of a delta light
    };

    /// All outlive this. `first`: the vertex whose values the columns begin with.
    Shining(const Stage& stage, const Transport& transport, const Scene& scene, std::size_t first);

    const std::vector<Part>& parts() const { return parts_; }

    /// Of a Lambertian material whose E tells its radiance: rho of the vertices [begin, begin +
    /// count), 0 where they are not seen.
    void albedo(kernel::Block& block, const Material& material, std::size_t begin,
                std::size_t count) const;

    /// Of another: L is what the vertices send out by themselves; and all that the lights share.
    void begin(kernel::Block& block, const Material& material, const kernel::Reflector& reflector,
               std::size_t begin, std::size_t count) const;
    /// Adds to L what they owe to one light.
    void add(kernel::Block& block, const kernel::Reflector& reflector, const Part& part,
             std::size_t begin) const;

  private:
    void look(kernel::Block& block, std::size_t begin) const;
    Rgb own(const kernel::Block& block, const Material& material, std::size_t begin,
            std::size_t i) const;
    void fill_rho(kernel::Block& block, const Material& material, std::size_t begin) const;
    void fill_axes(kernel::Block& block, double turn, std::size_t begin) const;

    const Stage& stage_;
    kernel::Viewer viewer_;
    bool both_sides_;
    std::size_t first_;
    std::vector<Part> parts_;
};

}  // namespace relight
