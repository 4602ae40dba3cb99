#pragma once

#include <embree3/rtcore.h>

#include <cstdint>
#include <span>
#include <vector>

#include "core/trace/stage.h"

namespace relight::bench {

/// The yardstick: a stage's triangles given to Embree itself, in the same recentred unit box and
/// with the same flags as our Bvh, and nothing of ours between rays and kernel.
class RawEmbree {
  public:
    explicit RawEmbree(const Stage& stage);
    RawEmbree(const RawEmbree&) = delete;
    RawEmbree& operator=(const RawEmbree&) = delete;
    ~RawEmbree();

    RTCScene scene() const { return scene_; }
    Vec3 to_box(Point3 p) const { return (p - centre_) * scale_; }
    RTCRay ray(const ShadowRay& shadow) const;
    std::vector<RTCRay> rays(std::span<const ShadowRay> shadows) const;

    /// Builds the tree anew.
    void commit();

  private:
    RTCDevice device_;
    RTCScene scene_ = nullptr;
    const Stage* stage_;
    std::vector<float> positions_;
    Point3 centre_;
    double scale_;
};

/// That of a terrain; made once and kept.
RawEmbree& terrain_embree(std::size_t vertices);

/// A ray of length `to` in the unit box.
RTCRay raw_ray(Vec3 origin, Vec3 direction, double from, double to);

/// How many rays are blocked: `rtcOccluded1`, ray after ray.
std::uint64_t blocked_one_by_one(RTCScene scene, std::span<const RTCRay> rays);

/// The same by `rtcOccluded1M`, `length` incoherent rays a call.
std::uint64_t blocked_in_streams(RTCScene scene, std::span<const RTCRay> rays, std::size_t length);

}  // namespace relight::bench
