#include "tests/bench/raw_embree.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "tests/bench/terrain.h"

namespace relight::bench {

RawEmbree::RawEmbree(const Stage& stage)
    : device_(rtcNewDevice(nullptr)),
      stage_(&stage),
      centre_(stage.surface->bounds.centre()),
      scale_(std::exp2(-std::ceil(std::log2(0.5 * stage.surface->bounds.diagonal()))))
{
    for (const Point3 p : stage.mesh->positions) {
        const Vec3 q = to_box(p);
        for (const double c : {q.x, q.y, q.z}) { positions_.push_back(static_cast<float>(c)); }
    }
    positions_.push_back(0.0F);  // Embree reads 16 bytes of each
    commit();
}

RawEmbree::~RawEmbree()
{
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
}

void RawEmbree::commit()
{
    if (scene_ != nullptr) { rtcReleaseScene(scene_); }
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               positions_.data(), 0, 3 * sizeof(float), positions_.size() / 3);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               stage_->surface->triangles.data(), 0, sizeof(Triangle),
                               stage_->surface->triangles.size());
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
}

RTCRay RawEmbree::ray(const ShadowRay& shadow) const
{
    return raw_ray(to_box(shadow.origin), shadow.direction, shadow.from * scale_,
                   shadow.distance * scale_);
}

std::vector<RTCRay> RawEmbree::rays(std::span<const ShadowRay> shadows) const
{
    std::vector<RTCRay> all;
    all.reserve(shadows.size());
    for (const ShadowRay& shadow : shadows) { all.push_back(ray(shadow)); }
    return all;
}

RawEmbree& terrain_embree(std::size_t vertices)
{
    static std::map<std::size_t, RawEmbree> kept;
    return kept.try_emplace(vertices, terrain_stage(vertices)).first->second;
}

RTCRay raw_ray(Vec3 origin, Vec3 direction, double from, double to)
{
    RTCRay r{};
    r.org_x = static_cast<float>(origin.x);
    r.org_y = static_cast<float>(origin.y);
    r.org_z = static_cast<float>(origin.z);
    r.dir_x = static_cast<float>(direction.x);
    r.dir_y = static_cast<float>(direction.y);
    r.dir_z = static_cast<float>(direction.z);
    r.tnear = static_cast<float>(from);
    r.tfar = static_cast<float>(to);
    r.mask = ~0U;
    return r;
}

std::uint64_t blocked_one_by_one(RTCScene scene, std::span<const RTCRay> rays)
{
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    std::uint64_t blocked = 0;
    for (RTCRay ray : rays) {
        rtcOccluded1(scene, &context, &ray);
        blocked += ray.tfar < 0.0F ? 1 : 0;
    }
    return blocked;
}

std::uint64_t blocked_in_streams(RTCScene scene, std::span<const RTCRay> rays, std::size_t length)
{
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    std::vector<RTCRay> stream;
    std::uint64_t blocked = 0;
    for (; !rays.empty(); rays = rays.subspan(stream.size())) {
        const auto next = rays.first(std::min(length, rays.size()));
        stream.assign(next.begin(), next.end());  // Embree writes what it finds over the rays
        rtcOccluded1M(scene, &context, stream.data(), static_cast<unsigned>(stream.size()),
                      sizeof(RTCRay));
        for (const RTCRay& ray : stream) { blocked += ray.tfar < 0.0F ? 1 : 0; }
    }
    return blocked;
}

}  // namespace relight::bench
