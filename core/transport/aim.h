#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/transport/slots.h"

namespace relight {

/// Where an asker's rays start and how far they go.
struct Start {
    Vec3 n, ng;
    Vec3 above;  ///< where rays start on the side of ng, from the origin; others below
    Vec3 below;
    Vec3 to_above;  ///< from the receiver
    Vec3 to_below;
    double from;
    Mask two_sided;
    double reach;      ///< as far as anything may cast a shadow
    double clearance;  ///< before the light
    UnitBox box;

    Start(const Receiver& receiver, const Bvh& bvh, const TransportOptions& options)
        : n(receiver.frame.n),
          ng(receiver.ng),
          above((receiver.lifted + ng * receiver.clear.offset) - Point3{}),
          below((receiver.lifted - ng * receiver.clear.offset) - Point3{}),
          to_above((Point3{} + above) - receiver.p),
          to_below((Point3{} + below) - receiver.p),
          from(receiver.clear.from),
          two_sided(where(options.two_sided)),
          reach(options.max_distance.value_or(std::numeric_limits<double>::infinity())),
          clearance(bvh.clearance(0.0).offset),
          box(bvh.box())
    {
    }
};

/// The shadow rays along the slots' directions, and what they bring.
template <bool is_far_away>
[[gnu::always_inline]] inline void aim_rays(const Receiver& receiver, const Bvh& bvh,
                                            const TransportOptions& options, unsigned lanes,
                                            std::size_t first, Slots& slots, RayFields& fields,
                                            Brought& E)
{
    const Start start(receiver, bvh, options);
    const unsigned count = whole(lanes);
    RELIGHT_APART
    for (unsigned i = 0; i < count; ++i) {
        const std::size_t slot = first + i;
        const Vec3 wi{slots.x[slot], slots.y[slot], slots.z[slot]};
        const double cos_n = dot(start.n, wi);
        const double cos_i = choose(start.two_sided, std::abs(cos_n), std::max(0.0, cos_n));
        const double weighted = slots.weight[slot] * cos_i;
        const double brought = choose(where(cos_i > 0.0), weighted, 0.0);
        const Mask is_above = where(dot(start.ng, wi) >= 0.0);
        const Point3 origin = Point3{} + choose(is_above, start.above, start.below);
        Vec3 aim = wi;
        double distance = start.reach;
        if constexpr (!is_far_away) {
            const double drawn = slots.distance[slot];
            const Vec3 to_light = wi * drawn - choose(is_above, start.to_above, start.to_below);
            const double squared = dot(to_light, to_light);
            // Beyond, it overflows, and where the ray starts makes no difference.
            const Mask is_far = where(!(squared < 1e200));
            // A light closer than the step itself is not behind anything.
            const Mask is_beside = ~(where(squared > 1e-200) & where(dot(to_light, wi) > 0.0));
            const double over = inverse_root(squared);
            const double far = choose(is_far, drawn, squared * over);
            const Mask as_drawn = is_far | is_beside;
            aim = choose(as_drawn, wi, to_light * over);
            distance =
                choose(is_beside, 0.0, std::max(0.0, std::min(start.reach, far - start.clearance)));
        }
        const BoxRay box = start.box.ray({origin, unit_already(aim), start.from, distance});
        E[slot] = brought;
        fields.org_x[slot] = box.org_x;
        fields.org_y[slot] = box.org_y;
        fields.org_z[slot] = box.org_z;
        fields.tnear[slot] = box.tnear;
        fields.dir_x[slot] = box.dir_x;
        fields.dir_y[slot] = box.dir_y;
        fields.dir_z[slot] = box.dir_z;
        fields.tfar[slot] = brought > 0.0 ? box.tfar : -std::numeric_limits<float>::infinity();
        fields.origin_x[slot] = origin.x;
        fields.origin_y[slot] = origin.y;
        fields.origin_z[slot] = origin.z;
        fields.direction_x[slot] = aim.x;
        fields.direction_y[slot] = aim.y;
        fields.direction_z[slot] = aim.z;
        fields.from[slot] = start.from;
        fields.distance[slot] = distance;
    }
}

}  // namespace relight
