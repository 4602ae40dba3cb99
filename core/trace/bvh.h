#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/base/progress.h"
#include "core/geometry/mesh.h"
#include "core/geometry/surface.h"
#include "core/trace/unit_box.h"

namespace relight {

/// What a ray meets first.
struct Hit {
    double distance{};          ///< scene units
    std::uint32_t primitive{};  ///< triangle of the Surface, or point of the cloud
    double u{}, v{};            ///< barycentric: p = (1-u-v) a + u b + v c; 0 for points
    bool is_point{};
};

struct RayFields;  // shadow_stream.h

/// How much care a tree is built with. Answers are the same, but for rays that run along a
/// silhouette to the last bits of a float: there either answer is right.
enum class TreeQuality {
    Fast,  ///< RTC_BUILD_QUALITY_LOW
    Good,  ///< RTC_BUILD_QUALITY_MEDIUM
};

/// The quality that answers soonest when so many rays are to be traced through so many triangles or
/// points, the building of the tree included.
TreeQuality tree_for(std::uint64_t rays, std::uint64_t primitives);

/// How rays are handed to Embree. Answers are the same, as above.
enum class RayPattern {
    OneByOne,  ///< rtcOccluded1: the fastest up to AVX
    Streams,   ///< rtcOccludedNp, incoherent: the fastest from AVX2 on
};

/// The fastest for this machine's instruction set.
RayPattern fastest_pattern();

/// Embree's acceleration structure over a surface's triangles, or over its points as oriented discs
/// when it has no triangles. Coordinates are recentred and scaled to the unit box (a power of two)
/// in double before they become float, so position and size of the model do not matter. Where
/// floats cannot tell on which side of a triangle a ray begins or ends, doubles do, so that a
/// millimetre beside a wall of kilometres is a millimetre. Immutable; any number of threads may ask
/// at once. Rays must be finite.
class Bvh {
  public:
    /// @param point_radius_scale radius of a cloud's discs in units of the local spacing
    /// @param progress ends the building at once when it is stopped; what is there then
    /// (progress.stopped()) is not to be asked. Embree may stop later: mesh and surface live on
    /// until it has.
    Bvh(const std::shared_ptr<const Mesh>& mesh, const std::shared_ptr<const Surface>& surface,
        double point_radius_scale, TreeQuality quality, Progress& progress,
        RayPattern pattern = fastest_pattern());
    /// The same of a mesh and a surface that the caller keeps. When it is stopped, it ends no
    /// sooner than Embree does: 0.1 s for two million triangles.
    Bvh(const Mesh& mesh, const Surface& surface, double point_radius_scale, TreeQuality quality,
        Progress& progress, RayPattern pattern = fastest_pattern());
    /// Good, and never stopped.
    Bvh(const Mesh& mesh, const Surface& surface, double point_radius_scale = 1.5);
    Bvh(Bvh&&) noexcept;
    Bvh& operator=(Bvh&&) noexcept;
    ~Bvh();

    /// blocked[i] = 1 where anything stands in the way of rays[i]. Robust; two-sided occluders.
    void occluded(std::span<const ShadowRay> rays, std::span<std::uint8_t> blocked) const;

    /// The nearest thing along direction further than `from` from the origin; primitive ~0 if none.
    /// Of things that floats cannot tell apart the one that is nearest in double, and of equals
    /// (the two sides of an edge, a face filed twice) the one of the lowest index.
    Hit nearest(Point3 origin, Dir3 direction, double from = 0.0) const;

    /// hits[i] = the nearest thing on rays[i], the same as asked for one by one; but where rays
    /// from one place go through the very edge of two faces, floats may know another of the two.
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
    Clearance clearance(double spacing) const { return clearance_(spacing); }
    const ClearanceRule& clearance() const { return clearance_; }

    TreeQuality quality() const;
    std::uint64_t bytes() const;                 ///< memory held
    const UnitBox& box() const { return box_; }  ///< in which rays are traced

    /// Version and instruction set of the ray kernel: "Embree 3.13.5, AVX2".
    static std::string kernel();

  private:
    friend class ShadowStream;
    /// Of the first blocked.size() rays; what is left of them is not to be used.
    void trace(RayFields& rays, std::span<std::uint8_t> blocked) const;

    struct Impl;
    UnitBox box_;
    ClearanceRule clearance_;
    std::unique_ptr<Impl> impl_;
};

}  // namespace relight
