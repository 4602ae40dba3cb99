#include "core/trace/bvh.h"

#include <embree3/rtcore.h>

#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

namespace relight {
namespace {

// Offsets off the surface, in units of the model's half diagonal (coordinates are in the unit box).
constexpr double least_offset = 1e-6;     // some ten roundings of a float coordinate
constexpr double largest_offset = 2e-5;   // measured: no false shadow at any size up to 1e5
constexpr double offset_per_edge = 1e-2;  // less where triangles are small: thin gaps still shadow
constexpr double offset_per_quantum = 4.0;  // roughness of coordinates that were rounded when filed

// A disc of a cloud must not shadow its own neighbourhood, which its neighbours overlap.
constexpr double radii_ignored = 2.0;

constexpr std::size_t stream_rays = 256;  // rays a call: the best of limits.md

RTCDevice device()
{
    static const RTCDevice shared = [] {
        RTCDevice d = rtcNewDevice(nullptr);
        if (d == nullptr) { throw std::runtime_error("Embree has no device"); }
        return d;
    }();
    return shared;
}

void must_be_well()
{
    if (const RTCError error = rtcGetDeviceError(device()); error != RTC_ERROR_NONE) {
        if (error == RTC_ERROR_OUT_OF_MEMORY) { throw std::bad_alloc(); }
        throw std::runtime_error("Embree error " + std::to_string(error));
    }
}

}  // namespace

struct Bvh::Impl {
    RTCScene scene = nullptr;
    const Mesh* mesh = nullptr;
    const Surface* surface = nullptr;
    Point3 centre;
    double scale = 1.0;  // scene units -> unit box; a power of two, so it rounds nothing
    double point_radius_scale = 0.0;
    bool streams = false;
    std::vector<float> vertices;  // xyz, or xyzr for discs; one spare at the end for Embree
    std::vector<float> disc_normals;
    std::vector<std::uint32_t> disc_point;  // point of each disc

    Impl() = default;
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;
    ~Impl()
    {
        if (scene != nullptr) { rtcReleaseScene(scene); }
    }

    Vec3 to_box(Point3 p) const { return (p - centre) * scale; }

    RTCGeometry triangles()
    {
        vertices.resize(3 * mesh->positions.size() + 1);
        float* to = vertices.data();
        for (const Point3 p : mesh->positions) {
            const Vec3 v = to_box(p);
            *to++ = static_cast<float>(v.x);
            *to++ = static_cast<float>(v.y);
            *to++ = static_cast<float>(v.z);
        }
        RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                   vertices.data(), 0, 3 * sizeof(float), mesh->positions.size());
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                   surface->triangles.data(), 0, sizeof(Triangle),
                                   surface->triangles.size());
        return geometry;
    }

    RTCGeometry discs()
    {
        for (std::size_t i = 0; i < mesh->positions.size(); ++i) {
            const double radius = point_radius_scale * static_cast<double>(surface->spacing[i]);
            if (!surface->normals[i] || !(radius > 0.0)) { continue; }
            push(to_box(mesh->positions[i]));
            vertices.push_back(static_cast<float>(radius * scale));
            const Vec3 n = surface->normals[i];
            for (const double c : {n.x, n.y, n.z}) {
                disc_normals.push_back(static_cast<float>(c));
            }
            disc_point.push_back(static_cast<std::uint32_t>(i));
        }
        disc_normals.push_back(0.0F);
        RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                                   vertices.data(), 0, 4 * sizeof(float), disc_point.size());
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_NORMAL, 0, RTC_FORMAT_FLOAT3,
                                   disc_normals.data(), 0, 3 * sizeof(float), disc_point.size());
        return geometry;
    }

    void push(Vec3 v)
    {
        for (const double c : {v.x, v.y, v.z}) { vertices.push_back(static_cast<float>(c)); }
    }

    RTCRay ray(Vec3 origin, Dir3 direction, double from, double to) const
    {
        RTCRay r{};
        r.org_x = static_cast<float>(origin.x);
        r.org_y = static_cast<float>(origin.y);
        r.org_z = static_cast<float>(origin.z);
        r.dir_x = static_cast<float>(direction.x());
        r.dir_y = static_cast<float>(direction.y());
        r.dir_z = static_cast<float>(direction.z());
        r.tnear = static_cast<float>(from);
        r.tfar = static_cast<float>(to);
        r.mask = ~0U;
        return r;
    }
};

Bvh::Bvh(const Mesh& mesh, const Surface& surface, double point_radius_scale)
    : impl_(std::make_unique<Impl>())
{
    Impl& b = *impl_;
    b.mesh = &mesh;
    b.surface = &surface;
    b.centre = surface.bounds.centre();
    b.point_radius_scale = point_radius_scale;
    const double half = 0.5 * surface.bounds.diagonal();
    b.scale = half > 0.0 ? std::exp2(-std::ceil(std::log2(half))) : 1.0;
    b.streams = rtcGetDeviceProperty(device(), RTC_DEVICE_PROPERTY_RAY_STREAM_SUPPORTED) != 0;
    b.scene = rtcNewScene(device());
    rtcSetSceneFlags(b.scene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = surface.triangles.empty() ? b.discs() : b.triangles();
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(b.scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(b.scene);
    must_be_well();
}

Bvh::Bvh(Bvh&&) noexcept = default;
Bvh& Bvh::operator=(Bvh&&) noexcept = default;
Bvh::~Bvh() = default;

void Bvh::occluded(std::span<const ShadowRay> rays, std::span<std::uint8_t> blocked) const
{
    const Impl& b = *impl_;
    // Nothing of the model lies further than its diagonal (2 in the box) from a receiver in its
    // bounds.
    const auto beyond = [&](Vec3 origin) { return 4.0 + length(origin); };
    std::array<RTCRay, stream_rays>
        stream;  // NOLINT(cppcoreguidelines-pro-type-member-init): filled below
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
    for (std::size_t begin = 0; begin < rays.size(); begin += stream_rays) {
        const std::size_t count = std::min(stream_rays, rays.size() - begin);
        for (std::size_t i = 0; i < count; ++i) {
            const ShadowRay& r = rays[begin + i];
            const Vec3 origin = b.to_box(r.origin);
            stream[i] = b.ray(origin, r.direction, r.from * b.scale,
                              std::min(r.distance * b.scale, beyond(origin)));
        }
        if (b.streams) {
            rtcOccluded1M(b.scene, &context, stream.data(), static_cast<unsigned>(count),
                          sizeof(RTCRay));
        } else {
            for (std::size_t i = 0; i < count; ++i) { rtcOccluded1(b.scene, &context, &stream[i]); }
        }
        for (std::size_t i = 0; i < count; ++i) {
            blocked[begin + i] = stream[i].tfar < 0.0F ? 1 : 0;  // Embree's sign of a hit: -inf
        }
    }
}

Hit Bvh::nearest(Point3 origin, Dir3 direction) const
{
    const Impl& b = *impl_;
    Hit hit;
    hit.primitive = ~0U;
    // Step up to the model's sphere first: floats are finest near it.
    const Vec3 to_centre = b.centre - origin;
    const double ahead = std::max(0.0, dot(to_centre, direction) - 2.0 / b.scale);
    const Vec3 start = b.to_box(origin + Vec3(direction) * ahead);
    if (!(length(start) < 8.0)) { return hit; }  // passes the model by
    RTCRayHit query{};
    query.ray = b.ray(start, direction, 0.0, 16.0);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect1(b.scene, &context, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) { return hit; }
    hit.distance = ahead + static_cast<double>(query.ray.tfar) / b.scale;
    if (b.surface->triangles.empty()) {
        hit.primitive = b.disc_point[query.hit.primID];
        hit.is_point = true;
        return hit;
    }
    // Embree found which triangle; where on it is solved again in double (Moeller-Trumbore).
    hit.primitive = query.hit.primID;
    const Triangle& t = b.surface->triangles[hit.primitive];
    const Point3 a = b.mesh->positions[t[0]];
    const Vec3 e1 = b.mesh->positions[t[1]] - a;
    const Vec3 e2 = b.mesh->positions[t[2]] - a;
    const Vec3 p = cross(direction, e2);
    const double determinant = dot(e1, p);
    hit.u = static_cast<double>(query.hit.u);
    hit.v = static_cast<double>(query.hit.v);
    if (determinant != 0.0) {
        const Vec3 s = origin - a;
        const Vec3 q = cross(s, e1);
        const double u = std::clamp(dot(s, p) / determinant, 0.0, 1.0);
        const double distance = dot(e2, q) / determinant;
        if (is_finite(u) && is_finite(distance)) {
            hit.u = u;
            hit.v = std::clamp(dot(direction, q) / determinant, 0.0, 1.0 - u);
            hit.distance = distance;
        }
    }
    return hit;
}

Clearance Bvh::clearance(double spacing) const
{
    const Impl& b = *impl_;
    const double half = 1.0 / b.scale;
    const double least = std::max(least_offset * half, offset_per_quantum * b.surface->quantum);
    if (b.surface->triangles.empty()) {
        return {least, radii_ignored * b.point_radius_scale * spacing};
    }
    return {std::max(least, std::min(largest_offset * half, offset_per_edge * spacing)), 0.0};
}

std::uint64_t Bvh::bytes() const
{
    constexpr std::uint64_t per_primitive = 65;  // measured for MEDIUM quality (limits.md)
    const Impl& b = *impl_;
    return sizeof(float) * (b.vertices.capacity() + b.disc_normals.capacity()) +
           sizeof(std::uint32_t) * b.disc_point.capacity() +
           per_primitive * (b.surface->triangles.size() + b.disc_point.size());
}

std::string Bvh::kernel()
{
    const auto version = rtcGetDeviceProperty(device(), RTC_DEVICE_PROPERTY_VERSION);
    std::string name = "Embree " + std::to_string(version / 10000) + "." +
                       std::to_string(version / 100 % 100) + "." + std::to_string(version % 100);
    if (rtcGetDeviceProperty(device(), RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED) != 0) {
        return name + ", AVX-512";
    }
    if (rtcGetDeviceProperty(device(), RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) != 0) {
        return name + ", AVX or AVX2";
    }
    return name + ", SSE";
}

}  // namespace relight
