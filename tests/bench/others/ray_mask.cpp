// Open3D 0.16 as Debian 12 builds it leaves a ray's mask 0, and Embree then meets nothing.
// Preloaded before Open3D, this gives every ray a full mask and passes it on: open3d_shadow.py.
#include <dlfcn.h>
#include <embree3/rtcore.h>

#include <cstddef>

namespace {

/// Embree's own function; Python loads it where RTLD_NEXT does not look.
template <class Function>
Function* embree(const char* name)
{
    void* library = dlopen("libembree3.so.3", RTLD_LAZY | RTLD_NOLOAD);
    return reinterpret_cast<Function*>(dlsym(library, name));
}

template <class Ray>
Ray& at(Ray* rays, unsigned i, std::size_t stride)
{
    return *reinterpret_cast<Ray*>(reinterpret_cast<char*>(rays) + i * stride);
}

}  // namespace

extern "C" {

void rtcOccluded1M(RTCScene scene, RTCIntersectContext* context, RTCRay* rays, unsigned count,
                   std::size_t stride)
{
    static const auto real = embree<decltype(rtcOccluded1M)>("rtcOccluded1M");
    for (unsigned i = 0; i < count; ++i) { at(rays, i, stride).mask = ~0U; }
    real(scene, context, rays, count, stride);
}

void rtcIntersect1M(RTCScene scene, RTCIntersectContext* context, RTCRayHit* rays, unsigned count,
                    std::size_t stride)
{
    static const auto real = embree<decltype(rtcIntersect1M)>("rtcIntersect1M");
    for (unsigned i = 0; i < count; ++i) { at(rays, i, stride).ray.mask = ~0U; }
    real(scene, context, rays, count, stride);
}
}
