#pragma once

#include <embree3/rtcore.h>

#include <cstdint>
#include <span>
#include <vector>

#include "core/trace/stage.h"

namespace relight::bench {

/// A ray in the unit box of Bvh, as Embree takes it.
struct RawRay {
    float origin[3];
    float from;
    float direction[3];
    float to;
};
RawRay raw_ray(const RTCRay& ray);
RTCRay rtc_ray(const RawRay& ray);
RTCRay rtc_ray(Vec3 origin, Vec3 direction, double from, double to);

/// The yardstick: a stage's triangles, or a cloud's discs, given to Embree itself, in the same
/// recentred unit box and with the same flags as our Bvh, and nothing of ours between rays and
/// kernel.
class RawEmbree {
  public:
    explicit RawEmbree(const Stage& stage);
    RawEmbree(const RawEmbree&) = delete;
    RawEmbree& operator=(const RawEmbree&) = delete;
    ~RawEmbree();

    RTCScene scene() const { return scene_; }
    Vec3 to_box(Point3 p) const { return (p - centre_) * scale_; }
    Point3 from_box(Vec3 p) const { return centre_ + p * (1.0 / scale_); }

    /// Builds the tree anew.
    void commit();

  private:
    RTCGeometry triangles() const;
    RTCGeometry discs() const;

    RTCDevice device_;
    RTCScene scene_ = nullptr;
    const Stage* stage_;
    std::vector<float> vertices_;  // xyz, or xyzr of discs
    std::vector<float> normals_;   // of discs
    Point3 centre_;
    double scale_;
};

/// That of a terrain, of the same as a cloud, and of outdoor_stage(); made once and kept.
RawEmbree& terrain_embree(std::size_t vertices);
RawEmbree& cloud_embree(std::size_t points);
RawEmbree& outdoor_embree(std::size_t vertices);

/// How many rays are blocked: `rtcOccluded1`, ray after ray.
std::uint64_t blocked_one_by_one(RTCScene scene, std::span<const RawRay> rays);

/// The same by `rtcOccluded1M`, `length` incoherent rays a call.
std::uint64_t blocked_in_streams(RTCScene scene, std::span<const RawRay> rays, std::size_t length);

/// The same by `rtcOccludedNp`: field by field.
std::uint64_t blocked_by_field(RTCScene scene, std::span<const RawRay> rays, std::size_t length);

}  // namespace relight::bench
