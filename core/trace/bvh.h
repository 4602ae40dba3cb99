#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/parallel.h"
#include "core/geometry/mesh.h"
#include "core/geometry/surface.h"

namespace relight {

/// A shadow ray in scene units: from p (already off the surface) toward wi, as far as `distance`.
struct ShadowRay {
    Point3 origin;
    Dir3 direction;
    double from{};      ///< nothing nearer than this counts, scene units
    double distance{};  ///< nothing beyond it does, scene units; infinite is allowed
};

/// What a ray meets first.
struct Hit {
    double distance{};          ///< scene units
    std::uint32_t primitive{};  ///< triangle of the Surface, or point of the cloud
    double u{}, v{};            ///< barycentric: p = (1-u-v) a + u b + v c; 0 for points
    bool is_point{};
};

/// A receiver steps `offset` along its normal before it looks around, and ignores what is nearer
/// than `from` along the ray. Both in scene units.
struct Clearance {
    double offset{};
    double from{};
};

/// Embree's acceleration structure over a surface's triangles, or over its points as oriented discs
/// when it has no triangles. Coordinates are recentred and scaled to the unit box (a power of two)
/// in double before they become float, so position and size of the model do not matter. Where
/// floats cannot tell on which side of a triangle a ray begins or ends, doubles do, so that a
/// millimetre beside a wall of kilometres is a millimetre. Immutable; any number of threads may ask
/// at once. Rays must be finite. Mesh and surface must outlive it (Stage).
class Bvh {
  public:
    /// @param point_radius_scale radius of a cloud's discs in units of the local spacing
    Bvh(const Mesh& mesh, const Surface& surface, double point_radius_scale = 1.5);
    Bvh(Bvh&&) noexcept;
    Bvh& operator=(Bvh&&) noexcept;
    ~Bvh();

    /// blocked[i] = 1 where anything stands in the way of rays[i]. Robust; two-sided occluders.
    void occluded(std::span<const ShadowRay> rays, std::span<std::uint8_t> blocked) const;

    /// The nearest thing along direction further than `from` from the origin; primitive ~0 if none.
    Hit nearest(Point3 origin, Dir3 direction, double from = 0.0) const;

    /// hits[i] = the nearest thing on rays[i], the same as asked for one by one.
    void nearest(std::span<const ShadowRay> rays, std::span<Hit> hits) const;

    /// The points of a cloud whose discs the ray meets, ascending. Costs about one `nearest`.
    std::vector<std::uint32_t> points_along(const ShadowRay& ray) const;

    /// Radius of a point's disc, scene units.
    double disc_radius(std::size_t point) const;

    /// Whether nothing that casts shadows rises above the plane through p with normal n by more
    /// than `margin` [scene units]: a receiver there sees its whole hemisphere and needs no rays.
    /// May answer no where a ray would find nothing; never yes where something rises (to within a
    /// rounding of double).
    bool open_above(Point3 p, Dir3 n, double margin) const;

    /// What a receiver with this spacing keeps clear of, so that it does not shadow itself.
    Clearance clearance(double spacing) const;

    std::uint64_t bytes() const;  ///< memory held

    /// Version and instruction set of the ray kernel: "Embree 3.13.5, AVX2".
    static std::string kernel();

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace relight
