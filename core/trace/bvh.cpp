#include "core/trace/bvh.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <new>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <vector>

#include "core/trace/extent.h"
#include "core/trace/occluders.h"
#include "core/trace/shadow_stream.h"

namespace relight {
namespace {

// Offsets off the surface, in units of the model's half diagonal (coordinates are in the unit box).
constexpr double least_offset = 1e-9;     // a million roundings: near hits are told in double
constexpr double largest_offset = 2e-5;   // measured: no false shadow at any size up to 1e5
constexpr double offset_per_edge = 1e-2;  // less where triangles are small: thin gaps still shadow
constexpr double offset_per_quantum = 4.0;  // roughness of coordinates that were rounded when filed

// A disc of a cloud must not shadow its own neighbourhood, which its neighbours overlap.
constexpr double radii_ignored = 2.0;

// Things on a ray that lie this close together [box] are told apart in double.
constexpr float apart = 1e-6F;

constexpr std::size_t most_hits = 256;  // looked for together

RTCRay embree_ray(const BoxRay& ray, unsigned id)
{
    RTCRay r{};
    r.org_x = ray.org_x;
    r.org_y = ray.org_y;
    r.org_z = ray.org_z;
    r.tnear = ray.tnear;
    r.dir_x = ray.dir_x;
    r.dir_y = ray.dir_y;
    r.dir_z = ray.dir_z;
    r.tfar = ray.tfar;
    r.mask = ~0U;
    r.id = id;
    return r;
}

/// What Embree asks of each ray of a stream beside what RayFields hold. It writes none of it.
struct SameForAll {
    std::array<float, RayFields::capacity> time{};
    std::array<unsigned, RayFields::capacity> mask{}, id{}, flags{};
    SameForAll()
    {
        mask.fill(~0U);
        std::iota(id.begin(), id.end(), 0U);
    }
};

RTCRayNp embree_rays(RayFields& f)
{
    static SameForAll same;
    RTCRayNp rays;
    rays.org_x = f.org_x.data();
    rays.org_y = f.org_y.data();
    rays.org_z = f.org_z.data();
    rays.tnear = f.tnear.data();
    rays.dir_x = f.dir_x.data();
    rays.dir_y = f.dir_y.data();
    rays.dir_z = f.dir_z.data();
    rays.time = same.time.data();
    rays.tfar = f.tfar.data();
    rays.mask = same.mask.data();
    rays.id = same.id.data();
    rays.flags = same.flags.data();
    return rays;
}

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

/// Streams gain on AVX2 and AVX-512 and lose before (limits.md). Embree does not tell AVX from
/// AVX2: it has eight lanes for both.
RayPattern fastest_pattern()
{
    const bool avx2 = has(RTC_DEVICE_PROPERTY_NATIVE_RAY8_SUPPORTED) &&
                      __builtin_cpu_supports("avx2") != 0;  // int in gcc, bool in clang
    return avx2 && has(RTC_DEVICE_PROPERTY_RAY_STREAM_SUPPORTED) ? RayPattern::Streams
                                                                 : RayPattern::OneByOne;
}

void must_be_well(const Progress& progress)
{
    const RTCError error = rtcGetDeviceError(device());
    if (error == RTC_ERROR_NONE || (error == RTC_ERROR_CANCELLED && progress.stopped())) { return; }
    if (error == RTC_ERROR_OUT_OF_MEMORY) { throw std::bad_alloc(); }
    throw std::runtime_error("Embree error " + std::to_string(error));
}

}  // namespace

struct Bvh::Impl {
    RTCScene scene = nullptr;
    TreeQuality quality = TreeQuality::Good;
    RayPattern pattern = fastest_pattern();
    Occluders occluders;
    Extent extent;  // of all that casts shadows, around the box's centre

    /// What Embree hands to confirm(): the rays asked for; an RTCRay's id is its place among them.
    struct Query : RTCIntersectContext {
        explicit Query(const Impl& b) : bvh(&b)
        {
            rtcInitIntersectContext(this);
            flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
        }
        ExactRay asked(unsigned ray) const
        {
            if (fields == nullptr) {
                const ShadowRay& r = rays[ray];
                return {r.origin, r.direction, r.from, r.distance};
            }
            const RayFields& f = *fields;
            return {{f.origin_x[ray], f.origin_y[ray], f.origin_z[ray]},
                    {f.direction_x[ray], f.direction_y[ray], f.direction_z[ray]},
                    f.from[ray],
                    f.distance[ray]};
        }
        const Impl* bvh;
        const RayFields* fields = nullptr;  // where they are, or:
        std::span<const ShadowRay> rays;
        /// Told of all that a ray meets, which goes on then. None: the first hit will do.
        std::function<void(std::uint32_t ray, std::uint32_t primitive)> notes;
    };

    Impl() = default;
    Impl(const Impl&) = delete;
    Impl& operator=(const Impl&) = delete;
    ~Impl()
    {
        if (scene != nullptr) { rtcReleaseScene(scene); }
    }

    RTCGeometry triangles() const
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

    RTCGeometry discs() const
    {
        RTCGeometry geometry = rtcNewGeometry(device(), RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                                   occluders.vertices.data(), 0, 4 * sizeof(float),
                                   occluders.count());
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_NORMAL, 0, RTC_FORMAT_FLOAT3,
                                   occluders.normals.data(), 0, 3 * sizeof(float),
                                   occluders.count());
        return geometry;
    }

    void build(Progress& progress)
    {
        const auto goes_on = [](void* asked, double /*share*/) {
            return !static_cast<const Progress*>(asked)->stopped();
        };
        const RTCBuildQuality care =
            quality == TreeQuality::Fast ? RTC_BUILD_QUALITY_LOW : RTC_BUILD_QUALITY_MEDIUM;
        scene = rtcNewScene(device());
        rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
        rtcSetSceneBuildQuality(scene, care);
        rtcSetSceneProgressMonitorFunction(scene, goes_on, &progress);
        RTCGeometry geometry = occluders.is_cloud() ? discs() : triangles();
        rtcSetGeometryBuildQuality(geometry, care);
        rtcSetGeometryIntersectFilterFunction(geometry, confirm);
        rtcSetGeometryOccludedFilterFunction(geometry, confirm);
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(scene, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene);
        must_be_well(progress);
    }

    /// Embree's filter: asked about each hit it finds. Strikes out those that are none in double,
    /// where float's word is not enough, and all of a query that takes notes.
    static void confirm(const RTCFilterFunctionNArguments* args)
    {
        const auto& query = *static_cast<const Query*>(args->context);
        for (unsigned i = 0; i < args->N; ++i) {
            if (args->valid[i] == 0) { continue; }
            const unsigned ray = RTCRayN_id(args->ray, args->N, i);
            const unsigned primitive = RTCHitN_primID(args->hit, args->N, i);
            const Vec3 normal{RTCHitN_Ng_x(args->hit, args->N, i),
                              RTCHitN_Ng_y(args->hit, args->N, i),
                              RTCHitN_Ng_z(args->hit, args->N, i)};
            const double t = RTCRayN_tfar(args->ray, args->N, i) - UnitBox::step_back;
            const bool met = query.bvh->occluders.is_met(query.asked(ray), t, normal, primitive);
            if (met && query.notes) { query.notes(ray, primitive); }
            if (!met || query.notes) { args->valid[i] = 0; }
        }
    }

    /// The ray begun beside the model, where floats are finest. None: it passes the model by.
    std::optional<ShadowRay> brought_near(const ShadowRay& r) const
    {
        const UnitBox& box = occluders.box;
        const double step =
            std::max(0.0, dot(box.centre - r.origin, r.direction) - 2.0 / box.scale);
        const Point3 start = r.origin + Vec3(r.direction) * step;
        if (!(length(box.to_box(start)) < 8.0) || !(r.distance > step)) { return {}; }
        return ShadowRay{start, r.direction, std::max(0.0, r.from - step), r.distance - step};
    }

    Hit hit(std::uint32_t primitive) const
    {
        Hit hit;
        hit.is_point = occluders.is_cloud();
        hit.primitive = hit.is_point ? occluders.point(primitive) : primitive;
        return hit;
    }

    /// What lies first of all that rays `asked` meet close to where floats `found` something.
    template <std::size_t most>
    void tell_apart(std::span<const ShadowRay> near, std::span<const ShadowRay* const> asked,
                    std::span<const RTCRayHit> found, std::span<std::optional<Hit>> first) const
    {
        std::array<bool, most> inside{};
        Query query(*this);
        query.rays = near;
        query.notes = [&](std::uint32_t k, std::uint32_t primitive) {
            const auto met = occluders.meeting(asked[k]->origin, asked[k]->direction, primitive);
            if (!met) { return; }
            Hit other = hit(primitive);
            other.distance = met->t;
            other.u = met->u;
            other.v = met->v;
            const auto rank = [](bool is_inside, const Hit& h) {
                return std::tuple(!is_inside, h.distance, h.primitive);
            };
            if (!first[k] || rank(met->inside, other) < rank(inside[k], *first[k])) {
                first[k] = other;
                inside[k] = met->inside;
            }
        };
        for (std::size_t k = 0; k < found.size(); ++k) {
            if (found[k].hit.geomID == RTC_INVALID_GEOMETRY_ID) { continue; }
            RTCRay ray = embree_ray(occluders.box.ray(near[k]), static_cast<unsigned>(k));
            ray.tnear = std::max(ray.tnear, found[k].ray.tfar - apart);
            ray.tfar = std::min(ray.tfar, found[k].ray.tfar + apart);
            rtcOccluded1(scene, &query, &ray);
        }
    }

    /// One stream of at most `most` rays.
    template <std::size_t most>
    void nearest(std::span<const ShadowRay> rays, std::span<Hit> hits) const
    {
        std::array<ShadowRay, most> near;          // those that come near the model
        std::array<const ShadowRay*, most> asked;  // of those, and what follows too; filled below
        std::array<RTCRayHit, most> found;
        std::size_t count = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            hits[i] = {};
            hits[i].primitive = ~0U;
            const auto begun = brought_near(rays[i]);
            if (!begun) { continue; }
            near[count] = *begun;
            found[count].ray = embree_ray(occluders.box.ray(*begun), static_cast<unsigned>(count));
            found[count].hit.geomID = RTC_INVALID_GEOMETRY_ID;
            asked[count++] = &rays[i];
        }
        Query query(*this);
        query.rays = near;
        for (std::size_t k = 0; k < count; ++k) { rtcIntersect1(scene, &query, &found[k]); }
        std::array<std::optional<Hit>, most> first;
        tell_apart<most>({near.data(), count}, {asked.data(), count}, {found.data(), count}, first);
        for (std::size_t k = 0; k < count; ++k) {
            if (found[k].hit.geomID == RTC_INVALID_GEOMETRY_ID) { continue; }
            Hit& to = hits[static_cast<std::size_t>(asked[k] - rays.data())];
            if (first[k]) {
                to = *first[k];
                continue;
            }
            // It lies in the plane of what floats saw: their word is all there is.
            to = hit(found[k].hit.primID);
            const double ahead = dot(near[k].origin - asked[k]->origin, near[k].direction);
            to.distance = ahead + (static_cast<double>(found[k].ray.tfar) - UnitBox::step_back) /
                                      occluders.box.scale;
            if (to.is_point) { continue; }
            to.u = static_cast<double>(found[k].hit.u);
            to.v = static_cast<double>(found[k].hit.v);
        }
    }
};

TreeQuality tree_for(std::uint64_t rays, std::uint64_t primitives)
{
    // Measured, 2 M triangles: Fast takes 0.47 s less of a processor to build and loses that again
    // at 9.4 M rays (limits.md: 14 M). Discs are built alike at either quality.
    constexpr std::uint64_t rays_a_primitive = 5;
    return rays / rays_a_primitive < primitives ? TreeQuality::Fast : TreeQuality::Good;
}

Bvh::Bvh(const Mesh& mesh, const Surface& surface, double point_radius_scale)
    : impl_(std::make_unique<Impl>())
{
    Progress never_stopped;
    *this = Bvh(mesh, surface, point_radius_scale, TreeQuality::Good, never_stopped);
}

Bvh::Bvh(const Mesh& mesh, const Surface& surface, double point_radius_scale, TreeQuality quality,
         Progress& progress)
    : impl_(std::make_unique<Impl>())
{
    Impl& b = *impl_;
    b.quality = quality;
    b.occluders = Occluders(mesh, surface, point_radius_scale, progress);
    box_ = b.occluders.box;
    const double half = 1.0 / box_.scale;
    clearance_.least = std::max(least_offset * half, offset_per_quantum * surface.quantum);
    clearance_.most = largest_offset * half;
    if (b.occluders.is_cloud()) {
        clearance_.from_per_spacing = radii_ignored * point_radius_scale;
    } else {
        clearance_.offset_per_spacing = offset_per_edge;
    }
    b.extent = extent_of(mesh, surface, box_.centre, point_radius_scale, progress);
    if (!progress.stopped()) { b.build(progress); }
}

Bvh::Bvh(Bvh&&) noexcept = default;
Bvh& Bvh::operator=(Bvh&&) noexcept = default;
Bvh::~Bvh() = default;

void Bvh::trace(RayFields& rays, std::span<std::uint8_t> blocked) const
{
    const Impl& b = *impl_;
    Impl::Query query(b);
    query.fields = &rays;
    if (b.pattern == RayPattern::Streams) {
        RTCRayNp stream = embree_rays(rays);
        rtcOccludedNp(b.scene, &query, &stream, static_cast<unsigned>(blocked.size()));
    } else {
        for (unsigned i = 0; i < blocked.size(); ++i) {
            if (rays.tfar[i] < 0.0F) { continue; }  // passed over
            RTCRay ray = embree_ray({rays.org_x[i], rays.org_y[i], rays.org_z[i], rays.tnear[i],
                                     rays.dir_x[i], rays.dir_y[i], rays.dir_z[i], rays.tfar[i]},
                                    i);
            rtcOccluded1(b.scene, &query, &ray);
            rays.tfar[i] = ray.tfar;
        }
    }
    for (std::size_t i = 0; i < blocked.size(); ++i) {
        blocked[i] = rays.tfar[i] < 0.0F ? 1 : 0;  // Embree's sign of a hit: -inf
    }
}

void Bvh::occluded(std::span<const ShadowRay> rays, std::span<std::uint8_t> blocked) const
{
    ShadowStream stream(*this);
    for (std::size_t begin = 0; begin < rays.size(); begin += ShadowStream::capacity) {
        const std::size_t count = std::min(ShadowStream::capacity, rays.size() - begin);
        for (const ShadowRay& ray : rays.subspan(begin, count)) { stream.put(ray); }
        const auto answers = stream.trace();
        std::copy(answers.begin(), answers.end(), blocked.subspan(begin).begin());
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
    for (std::size_t begin = 0; begin < rays.size(); begin += most_hits) {
        const std::size_t count = std::min(most_hits, rays.size() - begin);
        impl_->nearest<most_hits>(rays.subspan(begin, count), hits.subspan(begin, count));
    }
}

std::vector<std::uint32_t> Bvh::points_along(const ShadowRay& ray) const
{
    const Impl& b = *impl_;
    const auto begun = b.brought_near(ray);
    if (!b.occluders.is_cloud() || !begun) { return {}; }
    std::vector<std::uint32_t> met;
    Impl::Query query(b);
    query.rays = {&*begun, 1};
    query.notes = [&](std::uint32_t /*ray*/, std::uint32_t disc) {
        met.push_back(b.occluders.point(disc));
    };
    RTCRay r = embree_ray(box().ray(*begun), 0);
    rtcOccluded1(b.scene, &query, &r);
    std::sort(met.begin(), met.end());
    return met;
}

double Bvh::disc_radius(std::size_t point) const
{
    return impl_->occluders.disc_radius(point);
}

bool Bvh::open_above(Point3 p, Dir3 n, double margin) const
{
    return impl_->extent.reach(n) - dot(p - box().centre, n) <= margin;
}

TreeQuality Bvh::quality() const
{
    return impl_->quality;
}

std::uint64_t Bvh::bytes() const
{
    const Impl& b = *impl_;
    // Of Embree's tree, measured at a million vertices or points.
    const bool fast = b.quality == TreeQuality::Fast;
    const std::uint64_t per_primitive = b.occluders.is_cloud() ? 38 : fast ? 90 : 67;
    return b.occluders.bytes() + per_primitive * b.occluders.count();
}

void Bvh::use(RayPattern pattern)
{
    impl_->pattern = pattern;
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
