#include <algorithm>
#include <array>
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

/// EmitterTable::sample() from p before the front of a triangle whose share is `per_area` of its
/// area.
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
    return {wi, distance, choose(is_usual, share / angle, -1.0)};
}

}  // namespace

void sample(const EmitterTable& table, std::size_t count, MeshLanes& lanes)
{
    constexpr std::size_t most = MeshLanes::most;
    if (table.size() == 0) {
        std::fill_n(lanes.seen.pdf, count, 0.0);
        return;
    }
    // Only faces that show their front are looked at further, side by side. Listed without a
    // branch: which they are nobody foresees.
    std::array<const Emitter*, most + 1> face;
    std::array<std::uint32_t, most + 1> lane;
    std::size_t fronts = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const Emitter& emitter = table.drawn_by(lanes.pick[i]);
        face[fronts] = &emitter;
        lane[fronts] = static_cast<std::uint32_t>(i);
        const auto& [A, B, C] = emitter.corners;
        const Vec3 to_place = Point3{lanes.px[i], lanes.py[i], lanes.pz[i]} - A;
        fronts += dot(cross(B - A, C - A), to_place) > 0.0 ? 1 : 0;
    }
    for (double* of : {lanes.x, lanes.y, lanes.z, lanes.distance, lanes.seen.red, lanes.seen.green,
                       lanes.seen.blue, lanes.seen.pdf}) {
        std::fill_n(of, count, 0.0);
    }
    alignas(64) double u[most], v[most], px[most], py[most], pz[most], corners[9][most],
        per_area[most];
    const double per_total = 1.0 / table.cdf_.back();
    for (std::size_t k = 0; k < fronts; ++k) {
        const std::size_t i = lane[k];
        const Emitter& emitter = *face[k];
        u[k] = lanes.u[i];
        v[k] = lanes.v[i];
        px[k] = lanes.px[i];
        py[k] = lanes.py[i];
        pz[k] = lanes.pz[i];
        for (std::size_t c = 0; c < 3; ++c) {
            corners[3 * c][k] = emitter.corners[c].x;
            corners[3 * c + 1][k] = emitter.corners[c].y;
            corners[3 * c + 2][k] = emitter.corners[c].z;
        }
        per_area[k] = luminance(emitter.L) * per_total;
        lanes.seen.red[i] = emitter.L.r;
        lanes.seen.green[i] = emitter.L.g;
        lanes.seen.blue[i] = emitter.L.b;
    }
    alignas(64) double x[most], y[most], z[most], distance[most], pdf[most];
    in_vectors([&] {
        RELIGHT_APART
        for (std::size_t k = 0; k < fronts; ++k) {
            const Drawn there =
                draw_one({px[k], py[k], pz[k]}, {corners[0][k], corners[1][k], corners[2][k]},
                         {corners[3][k], corners[4][k], corners[5][k]},
                         {corners[6][k], corners[7][k], corners[8][k]}, per_area[k], {u[k], v[k]});
            x[k] = there.wi.x;
            y[k] = there.wi.y;
            z[k] = there.wi.z;
            distance[k] = there.distance;
            pdf[k] = there.pdf;
        }
    });
    for (std::size_t k = 0; k < fronts; ++k) {
        const std::size_t i = lane[k];
        lanes.x[i] = x[k];
        lanes.y[i] = y[k];
        lanes.z[i] = z[k];
        lanes.distance[i] = distance[k];
        lanes.seen.pdf[i] = pdf[k];
    }
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
