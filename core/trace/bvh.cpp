#include "core/trace/bvh.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <vector>

#include "core/trace/extent.h"
#include "core/trace/meeting.h"

namespace relight {
namespace {

// Offsets off the surface, in units of the model's half diagonal (coordinates are in the unit box).
constexpr double least_offset = 1e-9;     // a million roundings: near hits are told in double
constexpr double largest_offset = 2e-5;   // measured: no false shadow at any size up to 1e5
constexpr double offset_per_edge = 1e-2;  // less where triangles are small: thin gaps still shadow
constexpr double offset_per_quantum = 4.0;  // roughness of coordinates that were rounded when filed

// A disc of a cloud must not shadow its own neighbourhood, which its neighbours overlap.
constexpr double radii_ignored = 2.0;

// In units of the box: how far from a triangle's plane a ray must begin and end for floats to know
// on which side. Origin, corners and Embree's test err by up to 1.6e-7 (measured: large, small and
// sliver triangles, 1e-8 to 1 away). Nearer hits are told in double.
constexpr double float_slack = 1e-6;
// Floats start this much before the ray, lest rounding put them beyond what it should meet: what is
// met at more than 5 degrees to its plane is met. No more, because a receiver should not cross the
// surface it stands on (that costs a look in double): a mesh of 20 M triangles steps off by 3e-6.
constexpr double step_back = 2e-6;

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
    Extent extent;                          // of all that casts shadows, around `centre`

    /// What Embree hands to confirm(): the rays asked for; an RTCRay's id is its place among them.
    struct Query : RTCIntersectContext {
        Query(const Impl& b, std::span<const ShadowRay> r) : bvh(&b), rays(r)
        {
            rtcInitIntersectContext(this);
            flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
        }
        const Impl* bvh;
        std::span<const ShadowRay> rays;
        std::vector<std::uint32_t> met;  // primitives; filled by collect() alone
    };

    Impl() = default;
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;
    ~Impl()
    {
        if (scene != nullptr) { rtcReleaseScene(scene); }
    }

    Vec3 to_box(Point3 p) const { return (p - centre) * scale; }
    bool is_cloud() const { return surface->triangles.empty(); }
    double disc_radius(std::size_t point) const
    {
        return point_radius_scale * static_cast<double>(surface->spacing[point]);
    }

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
            const double radius = disc_radius(i);
            if (!surface->normals[i] || !(radius > 0.0)) { continue; }
            push(vertices, to_box(mesh->positions[i]));
            vertices.push_back(static_cast<float>(radius * scale));
            push(disc_normals, surface->normals[i]);
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

    static void push(std::vector<float>& to, Vec3 v)
    {
        for (const double c : {v.x, v.y, v.z}) { to.push_back(static_cast<float>(c)); }
    }

    RTCRay ray(const ShadowRay& asked, std::size_t id) const
    {
        const Vec3 direction = asked.direction;
        const Vec3 origin = to_box(asked.origin) - direction * step_back;
        // Nothing of the model lies further than its diagonal (2 in the box) from its bounds.
        const double beyond = 4.0 + std::abs(origin.x) + std::abs(origin.y) + std::abs(origin.z);
        RTCRay r{};
        r.org_x = static_cast<float>(origin.x);
        r.org_y = static_cast<float>(origin.y);
        r.org_z = static_cast<float>(origin.z);
        r.dir_x = static_cast<float>(direction.x);
        r.dir_y = static_cast<float>(direction.y);
        r.dir_z = static_cast<float>(direction.z);
        r.tnear = static_cast<float>(asked.from * scale);
        r.tfar = static_cast<float>(std::min(asked.distance * scale, beyond) + 2.0 * step_back);
        r.mask = ~0U;
        r.id = static_cast<unsigned>(id);
        return r;
    }

    std::optional<Meeting> meeting(Point3 origin, Vec3 direction, std::size_t primitive) const
    {
        if (is_cloud()) {
            const std::uint32_t i = disc_point[primitive];
            return meet_disc(direction, mesh->positions[i] - origin, surface->normals[i],
                             disc_radius(i));
        }
        const Triangle& t = surface->triangles[primitive];
        return meet_triangle(direction, mesh->positions[t[0]] - origin,
                             mesh->positions[t[1]] - origin, mesh->positions[t[2]] - origin);
    }

    /// Embree found which triangle; where on it is solved again in double.
    Hit hit(const ShadowRay& asked, const RTCRayHit& found, double ahead) const
    {
        Hit hit;
        hit.primitive = is_cloud() ? disc_point[found.hit.primID] : found.hit.primID;
        hit.is_point = is_cloud();
        if (const auto met = meeting(asked.origin, asked.direction, found.hit.primID)) {
            hit.distance = met->t;
            hit.u = met->u;
            hit.v = met->v;
            return hit;
        }
        hit.distance = ahead + (static_cast<double>(found.ray.tfar) - step_back) / scale;
        if (!hit.is_point) {
            hit.u = static_cast<double>(found.hit.u);
            hit.v = static_cast<double>(found.hit.v);
        }
        return hit;
    }

    /// One stream of at most `most` rays.
    template <std::size_t most>
    void nearest(std::span<const ShadowRay> rays, std::span<Hit> hits) const
    {
        std::array<ShadowRay, most> near;   // those that come near the model, begun beside it
        std::array<RTCRayHit, most> found;  // of those, and what follows too; filled below
        std::array<std::size_t, most> at;   // place in `rays`
        std::array<double, most> ahead;     // begun so much further
        std::size_t count = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const ShadowRay& r = rays[i];
            hits[i] = {};
            hits[i].primitive = ~0U;
            // Step up to the model's sphere first: floats are finest near it.
            const double step = std::max(0.0, dot(centre - r.origin, r.direction) - 2.0 / scale);
            const Point3 start = r.origin + Vec3(r.direction) * step;
            if (!(length(to_box(start)) < 8.0)) { continue; }  // passes the model by
            near[count] = {start, r.direction, std::max(0.0, r.from - step), r.distance - step};
            found[count].ray = ray(near[count], count);
            found[count].hit.geomID = RTC_INVALID_GEOMETRY_ID;
            ahead[count] = step;
            at[count++] = i;
        }
        Query query(*this, near);
        if (streams) {
            rtcIntersect1M(scene, &query, found.data(), static_cast<unsigned>(count),
                           sizeof(RTCRayHit));
        } else {
            for (std::size_t k = 0; k < count; ++k) { rtcIntersect1(scene, &query, &found[k]); }
        }
        for (std::size_t k = 0; k < count; ++k) {
            if (found[k].hit.geomID == RTC_INVALID_GEOMETRY_ID) { continue; }
            hits[at[k]] = hit(rays[at[k]], found[k], ahead[k]);
        }
    }

    /// Embree's filter: asked about each hit it finds. Strikes out those that are none in double,
    /// where float's word is not enough.
    static void confirm(const RTCFilterFunctionNArguments* args)
    {
        const auto& query = *static_cast<const Query*>(args->context);
        const double scale = query.bvh->scale;
        for (unsigned i = 0; i < args->N; ++i) {
            if (args->valid[i] == 0) { continue; }
            const ShadowRay& asked = query.rays[RTCRayN_id(args->ray, args->N, i)];
            const Vec3 normal{RTCHitN_Ng_x(args->hit, args->N, i),
                              RTCHitN_Ng_y(args->hit, args->N, i),
                              RTCHitN_Ng_z(args->hit, args->N, i)};
            const double t = RTCRayN_tfar(args->ray, args->N, i) - step_back;
            const double along = std::min(t - asked.from * scale, asked.distance * scale - t);
            // How far from the triangle's plane the nearer end is, against rounding.
            const double beside = along * std::abs(dot(normal, asked.direction));
            if (beside > 0.0 && beside * beside > float_slack * float_slack * dot(normal, normal)) {
                continue;
            }
            const std::optional<Meeting> met = query.bvh->meeting(
                asked.origin, asked.direction, RTCHitN_primID(args->hit, args->N, i));
            if (!(met && met->inside && met->t > asked.from && met->t < asked.distance)) {
                args->valid[i] = 0;
            }
        }
    }

    /// A query's own filter, asked after confirm(): notes every hit and strikes it out, so that the
    /// ray goes on.
    static void collect(const RTCFilterFunctionNArguments* args)
    {
        auto& query = *static_cast<Query*>(args->context);
        for (unsigned i = 0; i < args->N; ++i) {
            if (args->valid[i] == 0) { continue; }
            query.met.push_back(RTCHitN_primID(args->hit, args->N, i));
            args->valid[i] = 0;
        }
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
    rtcSetSceneFlags(b.scene, b.is_cloud()
                                  ? RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION
                                  : RTC_SCENE_FLAG_ROBUST);  // the former: collect()
    RTCGeometry geometry = b.is_cloud() ? b.discs() : b.triangles();
    rtcSetGeometryIntersectFilterFunction(geometry, Impl::confirm);
    rtcSetGeometryOccludedFilterFunction(geometry, Impl::confirm);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(b.scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(b.scene);
    must_be_well();
    b.extent = extent_of(mesh, surface, b.centre, point_radius_scale);
}

Bvh::Bvh(Bvh&&) noexcept = default;
Bvh& Bvh::operator=(Bvh&&) noexcept = default;
Bvh::~Bvh() = default;

void Bvh::occluded(std::span<const ShadowRay> rays, std::span<std::uint8_t> blocked) const
{
    const Impl& b = *impl_;
    std::array<RTCRay, stream_rays> stream;  // filled below
    Impl::Query query(b, rays);
    for (std::size_t begin = 0; begin < rays.size(); begin += stream_rays) {
        const std::size_t count = std::min(stream_rays, rays.size() - begin);
        for (std::size_t i = 0; i < count; ++i) { stream[i] = b.ray(rays[begin + i], begin + i); }
        if (b.streams) {
            rtcOccluded1M(b.scene, &query, stream.data(), static_cast<unsigned>(count),
                          sizeof(RTCRay));
        } else {
            for (std::size_t i = 0; i < count; ++i) { rtcOccluded1(b.scene, &query, &stream[i]); }
        }
        for (std::size_t i = 0; i < count; ++i) {
            blocked[begin + i] = stream[i].tfar < 0.0F ? 1 : 0;  // Embree's sign of a hit: -inf
        }
    }
}

Hit Bvh::nearest(Point3 origin, Dir3 direction, double from) const
{
    const ShadowRay ray{origin, direction, from, std::numeric_limits<double>::infinity()};
    Hit hit;
    impl_->nearest<1>({&ray, 1}, {&hit, 1});
    return hit;
}

void Bvh::nearest(std::span<const ShadowRay> rays, std::span<Hit> hits) const
{
    for (std::size_t begin = 0; begin < rays.size(); begin += stream_rays) {
        const std::size_t count = std::min(stream_rays, rays.size() - begin);
        impl_->nearest<stream_rays>(rays.subspan(begin, count), hits.subspan(begin, count));
    }
}

std::vector<std::uint32_t> Bvh::points_along(const ShadowRay& ray) const
{
    const Impl& b = *impl_;
    if (!b.is_cloud()) { return {}; }
    // As nearest() does: the ray starts where floats are fine.
    const double step = std::max(0.0, dot(b.centre - ray.origin, ray.direction) - 2.0 / b.scale);
    const Point3 start = ray.origin + Vec3(ray.direction) * step;
    if (!(length(b.to_box(start)) < 8.0) || !(ray.distance > step)) { return {}; }
    const ShadowRay near{start, ray.direction, std::max(0.0, ray.from - step), ray.distance - step};
    Impl::Query query(b, {&near, 1});
    query.filter = Impl::collect;
    RTCRay r = b.ray(near, 0);
    rtcOccluded1(b.scene, &query, &r);
    std::sort(query.met.begin(), query.met.end());
    for (std::uint32_t& point : query.met) { point = b.disc_point[point]; }  // ascending too
    return std::move(query.met);
}

double Bvh::disc_radius(std::size_t point) const
{
    return impl_->disc_radius(point);
}

bool Bvh::open_above(Point3 p, Dir3 n, double margin) const
{
    return impl_->extent.reach(n) - dot(p - impl_->centre, n) <= margin;
}

Clearance Bvh::clearance(double spacing) const
{
    const Impl& b = *impl_;
    const double half = 1.0 / b.scale;
    const double least = std::max(least_offset * half, offset_per_quantum * b.surface->quantum);
    if (b.is_cloud()) { return {least, radii_ignored * b.point_radius_scale * spacing}; }
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
