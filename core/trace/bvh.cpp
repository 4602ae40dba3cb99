#include "core/trace/bvh.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <functional>
#include <numeric>
#include <optional>
#include <vector>

#include "core/trace/bvh_impl.h"
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

/// What Embree hands to its filter: the rays asked for; an RTCRay's id is its place among them.
struct Query : RTCIntersectContext {
    explicit Query(const Occluders& o) : occluders(o)
    {
        rtcInitIntersectContext(this);
        flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
        filter = confirm;
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

    /// Asked about each hit that Embree finds. Strikes out those that are none in double, where
    /// float's word is not enough, and all of a query that takes notes.
    static void confirm(const RTCFilterFunctionNArguments* args)
    {
        for (unsigned i = 0; i < args->N; ++i) {
            if (args->valid[i] != 0 && !is_kept(args, i)) { args->valid[i] = 0; }
        }
    }
    static bool is_kept(const RTCFilterFunctionNArguments* args, unsigned i)
    {
        const auto& query = *static_cast<const Query*>(args->context);
        const unsigned ray = RTCRayN_id(args->ray, args->N, i);
        const Vec3 normal{RTCHitN_Ng_x(args->hit, args->N, i), RTCHitN_Ng_y(args->hit, args->N, i),
                          RTCHitN_Ng_z(args->hit, args->N, i)};
        const double t = RTCRayN_tfar(args->ray, args->N, i) - UnitBox::step_back;
        if (query.fields != nullptr) {
            // As it was given to Embree, which has that at hand; doubles are out of the cache.
            const Vec3 direction{RTCRayN_dir_x(args->ray, args->N, i),
                                 RTCRayN_dir_y(args->ray, args->N, i),
                                 RTCRayN_dir_z(args->ray, args->N, i)};
            const double after = t - RTCRayN_tnear(args->ray, args->N, i);
            const double before = query.fields->tfar[ray] - 2.0 * UnitBox::step_back - t;
            if (Occluders::is_plainly_met(std::min(after, before), direction, normal)) {
                return true;
            }
        }
        const unsigned primitive = RTCHitN_primID(args->hit, args->N, i);
        const bool met = query.occluders.is_met(query.asked(ray), t, normal, primitive);
        if (met && query.notes) { query.notes(primitive); }
        return met && !query.notes;
    }

    const Occluders& occluders;
    const RayFields* fields = nullptr;  // where they are, without notes; or:
    std::span<const ShadowRay> rays;
    /// Told of all that a ray meets, which goes on then. None: the first hit will do.
    std::function<void(std::uint32_t primitive)> notes;
};

}  // namespace

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

std::optional<ShadowRay> brought_near(const ShadowRay& r, const UnitBox& box)
{
    const double step = std::max(0.0, dot(box.centre - r.origin, r.direction) - 2.0 / box.scale);
    const Point3 start = r.origin + Vec3(r.direction) * step;
    if (!(length(box.to_box(start)) < 8.0) || !(r.distance > step)) { return {}; }
    return ShadowRay{start, r.direction, std::max(0.0, r.from - step), r.distance - step};
}

Bvh::Bvh(const Mesh& mesh, const Surface& surface, double point_radius_scale)
{
    Progress never_stopped;
    *this = Bvh(mesh, surface, point_radius_scale, TreeQuality::Good, never_stopped);
}

Bvh::Bvh(const Mesh& mesh, const Surface& surface, double point_radius_scale, TreeQuality quality,
         Progress& progress, RayPattern pattern)
    : Bvh(std::shared_ptr<const Mesh>(std::shared_ptr<void>(), &mesh),
          std::shared_ptr<const Surface>(std::shared_ptr<void>(), &surface), point_radius_scale,
          quality, progress, pattern)
{
}

Bvh::Bvh(const std::shared_ptr<const Mesh>& mesh, const std::shared_ptr<const Surface>& surface,
         double point_radius_scale, TreeQuality quality, Progress& progress, RayPattern pattern)
{
    auto occluders = std::make_shared<const Occluders>(mesh, surface, point_radius_scale, progress);
    box_ = occluders->box;
    const double half = 1.0 / box_.scale;
    clearance_.least = std::max(least_offset * half, offset_per_quantum * surface->quantum);
    clearance_.most = largest_offset * half;
    if (occluders->is_cloud()) {
        clearance_.from_per_spacing = radii_ignored * point_radius_scale;
    } else {
        clearance_.offset_per_spacing = offset_per_edge;
    }
    impl_ = std::make_unique<Impl>(std::move(occluders), quality, pattern);
    Impl& b = *impl_;
    b.extent = extent_of(*mesh, *surface, box_.centre, point_radius_scale, progress);
    if (!progress.stopped()) { b.tree = build_tree(b.shared, quality, progress); }
}

Bvh::Bvh(Bvh&&) noexcept = default;
Bvh& Bvh::operator=(Bvh&&) noexcept = default;
Bvh::~Bvh() = default;

void Bvh::trace(RayFields& rays, std::span<std::uint8_t> blocked) const
{
    const Impl& b = *impl_;
    Query query(b.occluders);
    query.fields = &rays;
    if (b.pattern == RayPattern::Streams) {
        RTCRayNp stream = embree_rays(rays);
        rtcOccludedNp(b.tree.get(), &query, &stream, static_cast<unsigned>(blocked.size()));
    } else {
        for (unsigned i = 0; i < blocked.size(); ++i) {
            if (rays.tfar[i] < 0.0F) { continue; }  // passed over
            RTCRay ray = embree_ray({rays.org_x[i], rays.org_y[i], rays.org_z[i], rays.tnear[i],
                                     rays.dir_x[i], rays.dir_y[i], rays.dir_z[i], rays.tfar[i]},
                                    i);
            rtcOccluded1(b.tree.get(), &query, &ray);
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

std::vector<std::uint32_t> Bvh::points_along(const ShadowRay& ray) const
{
    const Impl& b = *impl_;
    const auto begun = brought_near(ray, box_);
    if (!b.occluders.is_cloud() || !begun) { return {}; }
    std::vector<std::uint32_t> met;
    Query query(b.occluders);
    query.rays = {&*begun, 1};
    query.notes = [&](std::uint32_t disc) { met.push_back(b.occluders.point(disc)); };
    RTCRay r = embree_ray(box().ray(*begun), 0);
    rtcOccluded1(b.tree.get(), &query, &r);
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
    return b.occluders.bytes() + tree_bytes(b.occluders, b.quality);
}

}  // namespace relight
