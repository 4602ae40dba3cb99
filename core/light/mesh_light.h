#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
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

/// A box around all of a table's: no ray that passes it by meets one.
struct EmitterBounds {
    Vec3 low, high;

    /// Nothing within is on that side of the plane through p that n points to: it gives a place
    /// there no light.
    bool are_below(Point3 p, Vec3 n) const
    {
        const Vec3 highest{n.x > 0.0 ? high.x : low.x, n.y > 0.0 ? high.y : low.y,
                           n.z > 0.0 ? high.z : low.z};
        return dot(n, highest - (p - Point3{})) <= 0.0;
    }
};

class EmitterTree;
struct MeshLanes;

/// The mesh's own shining triangles. Drawn in proportion to luminance x area, then uniformly in
/// solid angle. Immutable.   Test: MeshLight.*
class EmitterTable {
  public:
    /// Triangles without area or light are left out; the rest is sorted by primitive.
    explicit EmitterTable(std::vector<Emitter> emitters);
    ~EmitterTable();

    LightSample sample(Point3 p, Sample2 s, double pick) const;
    /// What the triangle shows along wi to one who sees it there; black if it is none of these.
    LightSample look(std::uint32_t primitive, Point3 p, Dir3 wi) const;
    /// The same of the triangle that a ray from `origin` (p, or just off the surface there) along
    /// wi meets first, were there no others than these.
    LightSample look_along(Point3 origin, Point3 p, Dir3 wi) const;
    Rgb radiance(std::uint32_t primitive) const;  ///< of its front; black if it is none of these
    Rgb flux() const { return flux_; }            ///< sum of pi L A [scene units squared]
    std::size_t size() const { return emitters_.size(); }
    const EmitterBounds& bounds() const { return bounds_; }

  private:
    friend void sample(const EmitterTable& table, std::size_t count, MeshLanes& lanes);
    const Emitter* find(std::uint32_t primitive) const;
    const Emitter& drawn_by(double pick) const;
    LightSample look(const Emitter& emitter, Point3 p, Dir3 wi) const;
    std::vector<Emitter> emitters_;
    std::vector<double> cdf_;
    std::vector<std::uint32_t> guide_;  ///< of as many equal parts of cdf_: where to begin to look
    Rgb flux_;
    EmitterBounds bounds_;
    // Made when a ray first asks: who only keeps the light pays nothing.
    mutable std::once_flag is_planted_;
    mutable std::unique_ptr<const EmitterTree> tree_;
};

/// Places by the hundred from which an emitter is drawn, in lanes.
struct MeshLanes {
    static constexpr std::size_t most = SeenLanes::most;

    alignas(64) double u[most], v[most], pick[most];  ///< samples
    alignas(64) double px[most], py[most], pz[most];  ///< places
    alignas(64) double x[most], y[most], z[most];     ///< directions
    alignas(64) double distance[most];
    SeenLanes seen;
};
/// EmitterTable::sample() of the first `count` lanes, in vectors.   Test: MeshLanes.*
void sample(const EmitterTable& table, std::size_t count, MeshLanes& lanes);

/// Power multiplies the faces' radiance.
struct MeshLight {
    std::shared_ptr<const EmitterTable> table;
};

}  // namespace relight
