#include "core/trace/tree.h"

#include <embree3/rtcore.h>

#include <new>
#include <stdexcept>
#include <string>

#include "core/trace/builders.h"

namespace relight {
namespace {

RTCDevice device()
{
    static const RTCDevice shared = [] {
        RTCDevice d = rtcNewDevice(nullptr);
        if (d == nullptr) { throw std::runtime_error("Embree has no device"); }
        return d;
    }();
    return shared;
}

bool has(RTCDeviceProperty property)
{
    return rtcGetDeviceProperty(device(), property) != 0;
}

void must_be_well(const Progress& progress)
{
    const RTCError error = rtcGetDeviceError(device());
    if (error == RTC_ERROR_NONE || (error == RTC_ERROR_CANCELLED && progress.stopped())) { return; }
    if (error == RTC_ERROR_OUT_OF_MEMORY) { throw std::bad_alloc(); }
    throw std::runtime_error("Embree error " + std::to_string(error));
}

RTCGeometry triangles(const Occluders& occluders)
{
    RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               occluders.vertices.data(), 0, 3 * sizeof(float),
                               occluders.mesh->positions.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               occluders.surface->triangles.data(), 0, sizeof(Triangle),
                               occluders.count());
    return geometry;
}

RTCGeometry discs(const Occluders& occluders)
{
    RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                               occluders.vertices.data(), 0, 4 * sizeof(float), occluders.count());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_NORMAL, 0, RTC_FORMAT_FLOAT3,
                               occluders.normals.data(), 0, 3 * sizeof(float), occluders.count());
    return geometry;
}

Tree commit(const Occluders& occluders, TreeQuality quality, Progress& progress)
{
    const auto goes_on = [](void* asked, double /*share*/) {
        return !static_cast<const Progress*>(asked)->stopped();
    };
    const RTCBuildQuality care =
        quality == TreeQuality::Fast ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_MEDIUM;
    Tree scene(rtcNewScene(device()), rtcReleaseScene);
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
    rtcSetSceneBuildQuality(scene.get(), care);
    rtcSetSceneProgressMonitorFunction(scene.get(), goes_on, &progress);
    RTCGeometry geometry = occluders.is_cloud() ? discs(occluders) : triangles(occluders);
    rtcSetGeometryBuildQuality(geometry, care);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene.get(), geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene.get());
    must_be_well(progress);
    return progress.stopped() ? Tree() : scene;
}

}  // namespace

Tree build_tree(const std::shared_ptr<const Occluders>& occluders, TreeQuality quality,
                Progress& progress)
{
    // Embree asks whether to go on between the nodes, but not while it divides the first: of two
    // million triangles for 0.1 s. Of these few it is some milliseconds.
    constexpr std::size_t few = 100'000;
    const bool shared = occluders->mesh.use_count() > 0 && occluders->surface.use_count() > 0;
    if (!shared || occluders->count() < few) { return commit(*occluders, quality, progress); }

    struct Building {
        Progress progress;
        Tree tree;
    };
    static Builders builders;
    const auto building = std::make_shared<Building>();
    const auto work = [building, occluders, quality] {
        building->tree = commit(*occluders, quality, building->progress);
    };
    if (builders.run(work, progress)) { return building->tree; }
    building->progress.stop();
    return {};
}

TreeQuality tree_for(std::uint64_t rays, std::uint64_t primitives)
{
    // Measured, 2 M triangles: Fast takes 0.47 s less of a processor to build and loses that again
    // at 9.4 M rays (limits.md: 14 M). Discs are built alike at either quality.
    constexpr std::uint64_t rays_a_primitive = 5;
    return rays / rays_a_primitive < primitives ? TreeQuality::Fast : TreeQuality::Good;
}

std::uint64_t tree_bytes(const Occluders& occluders, TreeQuality quality)
{
    // Measured at a million vertices or points.
    const bool fast = quality == TreeQuality::Fast;
    const std::uint64_t per_primitive = occluders.is_cloud() ? 38 : fast ? 90 : 67;
    return per_primitive * occluders.count();
}

/// Streams gain on AVX2 and AVX-512 and lose before (limits.md). Embree does not tell AVX from
/// AVX2: it has eight lanes for both.
RayPattern fastest_pattern()
{
    const bool avx2 = has(RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) &&
                      __builtin_cpu_supports("avx2") != 0;  // int in gcc, bool in clang
    return avx2 && has(RTC_DEVICE_PROPERTY_RAY_STREAM_SUPPORTED) ? RayPattern::Streams
                                                                 : RayPattern::OneByOne;
}

std::string Bvh::kernel()
{
    const auto version = rtcGetDeviceProperty(device(), RTC_DEVICE_PROPERTY_VERSION);
    std::string name = "Embree " + std::to_string(version / 10000) + "." +
                       std::to_string(version / 100 % 100) + "." + std::to_string(version % 100);
    if (has(RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED)) { return name + ", AVX-512"; }
    if (has(RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED)) { return name + ", AVX or AVX2"; }
    return name + ", SSE";
}

}  // namespace relight
