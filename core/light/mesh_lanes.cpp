#include <algorithm>
#include <cmath>

#include "core/base/vectors.h"
#include "core/light/mesh_light.h"
#include "core/light/triangle_lanes.h"

// CMakeLists.txt has this file optimised for vectors.

namespace relight {
namespace {

struct Drawn {
    Vec3 wi;
    double distance, pdf;  ///< pdf < 0: sample() must tell
};

/// EmitterTable::sample() from p of a triangle whose share is `per_area` of its area.
inline Drawn draw_one(Point3 p, Point3 A, Point3 B, Point3 C, double per_area, Sample2 s)
{
    const Vec3 a = A - p, b = B - p, c = C - p;
    const Vec3 normal = cross(B - A, C - A);
    const double volume = dot(a, normal), normal2 = dot(normal, normal);
    const double a2 = dot(a, a), b2 = dot(b, b), c2 = dot(c, c);
    const double la = std::sqrt(a2), lb = std::sqrt(b2), lc = std::sqrt(c2);
    const double angle = lanes::solid_angle(a, b, c, la, lb, lc, volume);
    const SphericalTriangle seen =
        lanes::spherical(a * (1.0 / la), b * (1.0 / lb), c * (1.0 / lc), angle);
    const Vec3 wi = seen.direction(s);
    const double farthest2 = std::max(a2, std::max(b2, c2));
    const double nearest2 = std::min(a2, std::min(b2, c2));
    const double along = std::abs(volume) / std::abs(dot(wi, normal));
    const double distance = choose(where(along * along <= farthest2), along, std::sqrt(farthest2));
    const double share = per_area * (0.5 * std::sqrt(normal2));
    const auto squared = [](Vec3 v) { return dot(v, v); };
    const double longest2 = std::max(squared(b - a), std::max(squared(c - a), squared(c - b)));
    const double least2 = 4.0 * least_height * least_height * longest2 * normal2;
    const Mask is_usual = where(volume * volume > least2) & where(nearest2 > 1e-60) &
                          where(farthest2 < 1e60) & where(normal2 > 1e-200) &
                          where(normal2 < 1e200) & where(angle > 2.0 * least_solid_angle) &
                          where(dot(wi, wi) < 2.0);  // a number
    const double pdf = choose(where(volume < 0.0), share / angle, 0.0);
    return {wi, distance, choose(is_usual, pdf, -1.0)};
}

}  // namespace

void sample(const EmitterTable& table, std::size_t count, MeshLanes& lanes)
{
    constexpr std::size_t most = MeshLanes::most;
    if (table.size() == 0) {
        std::fill_n(lanes.seen.pdf, count, 0.0);
        return;
    }
    alignas(64) double corners[9][most], per_area[most];
    const double per_total = 1.0 / table.cdf_.back();
    for (std::size_t i = 0; i < count; ++i) {
        const Emitter& emitter = table.drawn_by(lanes.pick[i]);
        for (std::size_t k = 0; k < 3; ++k) {
            corners[3 * k][i] = emitter.corners[k].x;
            corners[3 * k + 1][i] = emitter.corners[k].y;
            corners[3 * k + 2][i] = emitter.corners[k].z;
        }
        per_area[i] = luminance(emitter.L) * per_total;
        lanes.seen.red[i] = emitter.L.r;
        lanes.seen.green[i] = emitter.L.g;
        lanes.seen.blue[i] = emitter.L.b;
    }
    in_vectors([&] {
        RELIGHT_APART
        for (std::size_t i = 0; i < count; ++i) {
            const Drawn there = draw_one({lanes.px[i], lanes.py[i], lanes.pz[i]},
                                         {corners[0][i], corners[1][i], corners[2][i]},
                                         {corners[3][i], corners[4][i], corners[5][i]},
                                         {corners[6][i], corners[7][i], corners[8][i]}, per_area[i],
                                         {lanes.u[i], lanes.v[i]});
            lanes.x[i] = there.wi.x;
            lanes.y[i] = there.wi.y;
            lanes.z[i] = there.wi.z;
            lanes.distance[i] = there.distance;
            lanes.seen.pdf[i] = there.pdf;
        }
    });
    for (std::size_t i = 0; i < count; ++i) {
        if (lanes.seen.pdf[i] >= 0.0) { continue; }
        const LightSample there = table.sample({lanes.px[i], lanes.py[i], lanes.pz[i]},
                                               {lanes.u[i], lanes.v[i]}, lanes.pick[i]);
        lanes.x[i] = there.wi.x();
        lanes.y[i] = there.wi.y();
        lanes.z[i] = there.wi.z();
        lanes.distance[i] = there.distance;
        lanes.seen.pdf[i] = there.pdf;
    }
}

}  // namespace relight
