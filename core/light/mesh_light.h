#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/sobol.h"
#include "core/light/light_sample.h"

namespace relight {

/// One shining triangle of the mesh: Lambertian, on its front.
struct Emitter {
    std::array<Point3, 3> corners;
    std::uint32_t primitive = 0;  ///< triangle of the Surface
    Rgb L;                        ///< its radiance at unit power, not negative
};

/// The mesh's own shining triangles. Drawn in proportion to luminance x area, then uniformly in
/// solid angle. Immutable.   Test: MeshLight.*
class EmitterTable {
  public:
    /// Triangles without area or light are left out; the rest is sorted by primitive.
    explicit EmitterTable(std::vector<Emitter> emitters);

    LightSample sample(Point3 p, Sample2 s, double pick) const;
    /// What the triangle shows along wi to one who sees it there; black if it is none of these.
    LightSample look(std::uint32_t primitive, Point3 p, Dir3 wi) const;
    Rgb radiance(std::uint32_t primitive) const;  ///< of its front; black if it is none of these
    Rgb flux() const { return flux_; }            ///< sum of pi L A [scene units squared]
    std::size_t size() const { return emitters_.size(); }

  private:
    const Emitter* find(std::uint32_t primitive) const;
    std::vector<Emitter> emitters_;
    std::vector<double> cdf_;
    Rgb flux_;
};

/// Power multiplies the faces' radiance.
struct MeshLight {
    std::shared_ptr<const EmitterTable> table;
};

}  // namespace relight
