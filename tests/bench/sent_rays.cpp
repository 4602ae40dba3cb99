#include "tests/bench/sent_rays.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/transport/transport.h"

namespace relight::bench {
namespace {

struct Overheard {
    std::vector<RawRay> rays;
    std::uint64_t blocked = 0;

    /// Embree skips a ray that ends before it begins.
    void before(const RTCRay& ray)
    {
        if (ray.tfar >= 0.0F) { rays.push_back(raw_ray(ray)); }
    }
    void after(bool was_asked, float tfar) { blocked += was_asked && tfar < 0.0F ? 1 : 0; }
};
Overheard* listening = nullptr;  // while one thread alone traces

}  // namespace

// The names that ld's --wrap gives: __real_X is Embree's X, and who calls X gets __wrap_X.
extern "C" {
void real_1(RTCScene, RTCIntersectContext*, RTCRay*) __asm__("__real_rtcOccluded1");
void real_1m(RTCScene, RTCIntersectContext*, RTCRay*, unsigned,
             std::size_t) __asm__("__real_rtcOccluded1M");
void real_np(RTCScene, RTCIntersectContext*, const RTCRayNp*,
             unsigned) __asm__("__real_rtcOccludedNp");
void heard_1(RTCScene, RTCIntersectContext*, RTCRay*) __asm__("__wrap_rtcOccluded1");
void heard_1m(RTCScene, RTCIntersectContext*, RTCRay*, unsigned,
              std::size_t) __asm__("__wrap_rtcOccluded1M");
void heard_np(RTCScene, RTCIntersectContext*, const RTCRayNp*,
              unsigned) __asm__("__wrap_rtcOccludedNp");

void heard_1(RTCScene scene, RTCIntersectContext* context, RTCRay* ray)
{
    if (listening == nullptr) { return real_1(scene, context, ray); }
    const bool asked = ray->tfar >= 0.0F;
    listening->before(*ray);
    real_1(scene, context, ray);
    listening->after(asked, ray->tfar);
}

void heard_1m(RTCScene scene, RTCIntersectContext* context, RTCRay* rays, unsigned count,
              std::size_t stride)
{
    if (listening == nullptr) { return real_1m(scene, context, rays, count, stride); }
    const auto at = [&](unsigned i) -> RTCRay& {
        return *reinterpret_cast<RTCRay*>(reinterpret_cast<char*>(rays) + i * stride);
    };
    std::vector<bool> asked;
    for (unsigned i = 0; i < count; ++i) {
        asked.push_back(at(i).tfar >= 0.0F);
        listening->before(at(i));
    }
    real_1m(scene, context, rays, count, stride);
    for (unsigned i = 0; i < count; ++i) { listening->after(asked[i], at(i).tfar); }
}

void heard_np(RTCScene scene, RTCIntersectContext* context, const RTCRayNp* rays, unsigned count)
{
    if (listening == nullptr) { return real_np(scene, context, rays, count); }
    std::vector<bool> asked;
    for (unsigned i = 0; i < count; ++i) {
        RTCRay ray{};
        ray.org_x = rays->org_x[i];
        ray.org_y = rays->org_y[i];
        ray.org_z = rays->org_z[i];
        ray.tnear = rays->tnear[i];
        ray.dir_x = rays->dir_x[i];
        ray.dir_y = rays->dir_y[i];
        ray.dir_z = rays->dir_z[i];
        ray.tfar = rays->tfar[i];
        asked.push_back(ray.tfar >= 0.0F);
        listening->before(ray);
    }
    real_np(scene, context, rays, count);
    for (unsigned i = 0; i < count; ++i) { listening->after(asked[i], rays->tfar[i]); }
}
}

namespace {

/// The terrain's vertex that a ray leaves from: its steps off the surface are far shorter than an
/// edge, and the vertices a square grid, row after row.
std::size_t vertex_of(const RawRay& ray, const RawEmbree& raw, std::size_t vertices, bool faces_y)
{
    const double side = std::sqrt(static_cast<double>(vertices));
    const auto nearest = [side](double x) {
        return std::clamp(std::round(0.5 * (x + 1.0) * (side - 1.0)), 0.0, side - 1.0);
    };
    const Point3 p = raw.from_box({ray.origin[0], ray.origin[1], ray.origin[2]});
    return static_cast<std::size_t>(nearest(faces_y ? -p.z : p.y) * side + nearest(p.x));
}

/// Rays in ascending order of `keys` (below `most`); equal ones stay as they are.
std::vector<RawRay> sorted(const std::vector<RawRay>& rays, const std::vector<std::uint32_t>& keys,
                           std::size_t most)
{
    std::vector<std::size_t> place(most + 1);
    for (const std::uint32_t key : keys) { ++place[key + 1]; }
    std::partial_sum(place.begin(), place.end(), place.begin());
    std::vector<RawRay> in_order(rays.size());
    for (std::size_t r = 0; r < rays.size(); ++r) { in_order[place[keys[r]]++] = rays[r]; }
    return in_order;
}

}  // namespace

SentRays sent_rays(const Stage& stage, const RawEmbree& raw, const Scene& scene, std::size_t grid,
                   bool faces_y)
{
    Overheard overheard;
    TransportWanted alone;
    alone.threads = 1;
    Progress progress;
    listening = &overheard;
    SentRays sent;
    sent.told = trace(stage, scene, alone, progress).rays;
    listening = nullptr;
    sent.blocked = overheard.blocked;

    const std::size_t vertices = stage.mesh->positions.size();
    const auto& order = stage.surface->order;
    std::vector<std::uint32_t> rank(vertices);
    for (std::uint32_t i = 0; i < vertices; ++i) { rank[order.empty() ? i : order[i]] = i; }
    std::vector<std::uint32_t> keys;
    for (const RawRay& ray : overheard.rays) {
        keys.push_back(static_cast<std::uint32_t>(vertex_of(ray, raw, grid, faces_y)));
    }
    sent.by_mesh = sorted(overheard.rays, keys, vertices);
    for (std::uint32_t& key : keys) { key = rank[key]; }
    sent.by_morton = sorted(overheard.rays, keys, vertices);
    return sent;
}

}  // namespace relight::bench
