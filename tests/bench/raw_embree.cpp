#include "tests/bench/raw_embree.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "tests/bench/terrain.h"

namespace relight::bench {

RawRay raw_ray(const RTCRay& r)
{
    return {{r.org_x, r.org_y, r.org_z}, r.tnear, {r.dir_x, r.dir_y, r.dir_z}, r.tfar};
}

RTCRay rtc_ray(const RawRay& ray)
{
    RTCRay r{};
    r.org_x = ray.origin[0];
    r.org_y = ray.origin[1];
    r.org_z = ray.origin[2];
    r.tnear = ray.from;
    r.dir_x = ray.direction[0];
    r.dir_y = ray.direction[1];
    r.dir_z = ray.direction[2];
    r.tfar = ray.to;
    r.mask = ~0U;
    return r;
}

RTCRay rtc_ray(Vec3 origin, Vec3 direction, double from, double to)
{
    const auto f = [](double x) { return static_cast<float>(x); };
    return rtc_ray({{f(origin.x), f(origin.y), f(origin.z)},
                    f(from),
                    {f(direction.x), f(direction.y), f(direction.z)},
                    f(to)});
}

RawEmbree::RawEmbree(const Stage& stage)
    : device_(rtcNewDevice(nullptr)),
      stage_(&stage),
      centre_(stage.surface->bounds.centre()),
      scale_(std::exp2(-std::ceil(std::log2(0.5 * stage.surface->bounds.diagonal()))))
{
    const auto push = [](std::vector<float>& to, Vec3 v) {
        for (const double c : {v.x, v.y, v.z}) { to.push_back(static_cast<float>(c)); }
    };
    const bool is_cloud = stage.surface->triangles.empty();
    for (std::size_t v = 0; v < stage.mesh->positions.size(); ++v) {
        push(vertices_, to_box(stage.mesh->positions[v]));
        if (!is_cloud) { continue; }
        vertices_.push_back(static_cast<float>(stage.bvh->disc_radius(v) * scale_));
        push(normals_, stage.surface->normals[v]);
    }
    vertices_.push_back(0.0F);  // Embree reads 16 bytes of each
    normals_.push_back(0.0F);
    commit();
}

RawEmbree::~RawEmbree()
{
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
}

RTCGeometry RawEmbree::triangles() const
{
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               vertices_.data(), 0, 3 * sizeof(float),
                               stage_->mesh->positions.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               stage_->surface->triangles.data(), 0, sizeof(Triangle),
                               stage_->surface->triangles.size());
    return geometry;
}

RTCGeometry RawEmbree::discs() const
{
    const std::size_t points = stage_->mesh->positions.size();
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                               vertices_.data(), 0, 4 * sizeof(float), points);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_NORMAL, 0, RTC_FORMAT_FLOAT3,
                               normals_.data(), 0, 3 * sizeof(float), points);
    return geometry;
}

void RawEmbree::commit()
{
    if (scene_ != nullptr) { rtcReleaseScene(scene_); }
    scene_ = rtcNewScene(device_);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = stage_->surface->triangles.empty() ? discs() : triangles();
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
}

RawEmbree& terrain_embree(std::size_t vertices)
{
    static std::map<std::size_t, RawEmbree> kept;
    return kept.try_emplace(vertices, terrain_stage(vertices)).first->second;
}

RawEmbree& cloud_embree(std::size_t points)
{
    static std::map<std::size_t, RawEmbree> kept;
    return kept.try_emplace(points, cloud_stage(points)).first->second;
}

RawEmbree& outdoor_embree(std::size_t vertices)
{
    static std::map<std::size_t, RawEmbree> kept;
    return kept.try_emplace(vertices, outdoor_stage(vertices)).first->second;
}

std::uint64_t blocked_one_by_one(RTCScene scene, std::span<const RawRay> rays)
{
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    std::uint64_t blocked = 0;
    for (const RawRay& asked : rays) {
        RTCRay ray = rtc_ray(asked);
        rtcOccluded1(scene, &context, &ray);
        blocked += ray.tfar < 0.0F ? 1 : 0;
    }
    return blocked;
}

std::uint64_t blocked_in_streams(RTCScene scene, std::span<const RawRay> rays, std::size_t length)
{
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    std::vector<RTCRay> stream(length);
    std::uint64_t blocked = 0;
    while (!rays.empty()) {
        const std::size_t count = std::min(length, rays.size());
        for (std::size_t i = 0; i < count; ++i) { stream[i] = rtc_ray(rays[i]); }
        rtcOccluded1M(scene, &context, stream.data(), static_cast<unsigned>(count), sizeof(RTCRay));
        for (std::size_t i = 0; i < count; ++i) { blocked += stream[i].tfar < 0.0F ? 1 : 0; }
        rays = rays.subspan(count);
    }
    return blocked;
}

std::uint64_t blocked_by_field(RTCScene scene, std::span<const RawRay> rays, std::size_t length)
{
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    constexpr std::size_t fields = 9;  // origin, from, direction, to, and a time of 0
    std::vector<float> stream(fields * length);
    const auto field = [&](std::size_t f) { return stream.data() + f * length; };
    std::vector<unsigned> masks(length, ~0U), none(length, 0U);
    const RTCRayNp all{field(0), field(1), field(2), field(3),     field(4),    field(5),
                       field(6), field(8), field(7), masks.data(), none.data(), none.data()};
    std::uint64_t blocked = 0;
    while (!rays.empty()) {
        const std::size_t count = std::min(length, rays.size());
        for (std::size_t i = 0; i < count; ++i) {
            for (std::size_t k = 0; k < 3; ++k) {
                field(k)[i] = rays[i].origin[k];
                field(4 + k)[i] = rays[i].direction[k];
            }
            field(3)[i] = rays[i].from;
            field(7)[i] = rays[i].to;
        }
        rtcOccludedNp(scene, &context, &all, static_cast<unsigned>(count));
        for (std::size_t i = 0; i < count; ++i) { blocked += field(7)[i] < 0.0F ? 1 : 0; }
        rays = rays.subspan(count);
    }
    return blocked;
}

}  // namespace relight::bench
