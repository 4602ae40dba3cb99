#include "core/transport/draws.h"

#include <algorithm>
#include <cmath>

#include "core/transport/aim.h"

// CMakeLists.txt has this file optimised for vectors: sums and products are not fused (they would
// round otherwise where a processor can), so that every processor has the same bits.

namespace relight {
namespace {

/// Distances to shining faces: rays end before them.
[[gnu::always_inline]] inline void stop_before_faces(const MeshLanes& lanes, const Bvh& bvh,
                                                     std::size_t count, Slots& slots)
{
    RELIGHT_APART
    for (std::size_t slot = 0; slot < count; ++slot) {
        slots.weight[slot] = lanes.seen.pdf[slot] > 0.0 ? 1.0 : 0.0;
        slots.distance[slot] = short_of_face(bvh, lanes.distance[slot]);
    }
}

/// Which directions may meet faces within the bounds: a weight of 1, else 0.
[[gnu::always_inline]] inline void meet_bounds(const EmitterBounds& within, const Start& of,
                                               unsigned lanes, std::size_t first, Slots& slots)
{
    const Start start = of;
    const EmitterBounds box = within;
    constexpr double least = 1e-200;  // not 0: 0 times its infinite inverse is no number
    RELIGHT_APART
    for (unsigned i = 0; i < lanes; ++i) {
        const std::size_t slot = first + i;
        const Vec3 wi{slots.x[slot], slots.y[slot], slots.z[slot]};
        const Vec3 from = choose(where(dot(start.ng, wi) >= 0.0), start.above, start.below);
        double in = 0.0, out = std::numeric_limits<double>::infinity();
        const auto narrow = [&](double low, double high, double along) {
            const double per = 1.0 / std::copysign(std::max(std::abs(along), least), along);
            in = std::max(in, std::min(low * per, high * per));
            out = std::min(out, std::max(low * per, high * per));
        };
        const Vec3 low = box.low - from, high = box.high - from;
        narrow(low.x, high.x, wi.x);
        narrow(low.y, high.y, wi.y);
        narrow(low.z, high.z, wi.z);
        slots.weight[slot] = in <= out ? 1.0 : 0.0;
    }
}

/// What those directions meet.
void meet_faces(std::span<const Asker<MeshCosines>> askers, unsigned lanes, Slots& slots)
{
    std::size_t slot = 0;
    for (const Asker<MeshCosines>& asker : askers) {
        const Receiver& at = *asker.receiver;
        MeshLanes& all = *asker.view.lanes;
        for (const std::size_t end = slot + lanes; slot < end; ++slot) {
            LightSample there;
            if (slots.weight[slot] > 0.0) {
                const Dir3 wi = unit_already({slots.x[slot], slots.y[slot], slots.z[slot]});
                there = asker.view.faces->look_along(ray_start(at, wi), at.p, wi);
            }
            all.distance[slot] = there.distance;
            all.seen.red[slot] = there.L.r;
            all.seen.green[slot] = there.L.g;
            all.seen.blue[slot] = there.L.b;
            all.seen.pdf[slot] = there.pdf;
        }
    }
}

}  // namespace

std::vector<Lanes> lanes_of(unsigned replicates, unsigned begin, unsigned end)
{
    std::vector<Lanes> all;
    for (unsigned r = 0; r < replicates; ++r) {
        for (unsigned i = begin; i < end; ++i) {
            if (all.empty() || all.back().count == Lanes::most) { all.emplace_back(); }
            Lanes& lanes = all.back();
            lanes.replicate[lanes.count] = r;
            lanes.point[lanes.count++] = i;
        }
    }
    return all;
}

template <class View>
void draw(std::span<const Asker<View>> askers, const Bvh& bvh, const TransportOptions& options,
          std::uint32_t pair, const Lanes& lanes, ShadowStream& stream, Brought& E)
{
    constexpr bool is_dome = std::is_same_v<View, DomeDirections>;
    constexpr bool is_mesh = std::is_same_v<View, MeshDirections>;
    constexpr bool is_cosines = std::is_same_v<View, MeshCosines>;
    constexpr bool is_far_away = is_dome || std::is_same_v<View, SunView> ||
                                 std::is_same_v<View, CosineView> ||
                                 std::is_same_v<View, CosineDirections>;
    Slots slots;
#ifdef __clang_analyzer__  // it does not see that each step fills what the next one reads
    slots = {};
#endif
    RayFields& fields = stream.fields();
    const auto each = [&](const auto& make) {
        std::size_t first = 0;
        for (const Asker<View>& asker : askers) {
            make(asker, first);
            first += lanes.count;
        }
    };
    const auto pass_over = [&](std::size_t first) {
        std::fill_n(E.begin() + static_cast<std::ptrdiff_t>(first), lanes.count, 0.0);
        stream.resize(first);
        for (unsigned i = 0; i < lanes.count; ++i) { stream.pass_over(); }
    };
    const std::size_t count = askers.size() * lanes.count;
    const auto draw_pair = [&](std::uint32_t which) {
        in_vectors([&] {
            each([&](const Asker<View>& asker, std::size_t first) {
                draw_samples(asker.sequence, which, lanes, first, slots);
            });
        });
    };
    if constexpr (is_dome || is_mesh) {
        auto& all = *askers.front().view.lanes;
        static_assert(SeenLanes::most >= Slots::most);
        bool has_parts = true;
        if constexpr (is_dome) { has_parts = askers.front().view.dome->has_parts(); }
        in_vectors([&] {
            if (!has_parts) { return; }
            each([&](const Asker<View>& asker, std::size_t first) {
                draw_picks(asker.sequence, pair + 1, lanes, all.pick + first);
            });
        });
        draw_pair(pair);
        std::copy_n(slots.u, count, all.u);
        std::copy_n(slots.v, count, all.v);
        if constexpr (is_dome) {
            sample(*askers.front().view.dome, count, all);
            std::fill_n(slots.weight, count, 1.0);
        } else {
            each([&](const Asker<View>& asker, std::size_t first) {
                const Point3 p = asker.receiver->p;
                std::fill_n(all.px + first, lanes.count, p.x);
                std::fill_n(all.py + first, lanes.count, p.y);
                std::fill_n(all.pz + first, lanes.count, p.z);
            });
            sample(*askers.front().view.faces, count, all);
            in_vectors([&] { stop_before_faces(all, bvh, count, slots); });
        }
        std::copy_n(all.x, count, slots.x);
        std::copy_n(all.y, count, slots.y);
        std::copy_n(all.z, count, slots.z);
    } else {
        draw_pair(pair);
        in_vectors([&] {
            each([&](const Asker<View>& asker, std::size_t first) {
                draw_directions(asker.view, lanes.count, first, slots);
            });
        });
    }
    if constexpr (is_cosines) {
        in_vectors([&] {
            each([&](const Asker<View>& asker, std::size_t first) {
                meet_bounds(asker.view.faces->bounds(), Start(*asker.receiver, bvh, options),
                            lanes.count, first, slots);
            });
        });
        meet_faces(askers, lanes.count, slots);
        in_vectors([&] { stop_before_faces(*askers.front().view.lanes, bvh, count, slots); });
    }
    if constexpr (std::is_same_v<View, RectView>) {
        each([&](const Asker<View>& asker, std::size_t first) {
            if (!asker.view.by_area()) { return; }
            for (std::size_t slot = first; slot < first + lanes.count; ++slot) {
                const LightSample there = asker.view.sample({slots.u[slot], slots.v[slot]});
                slots.x[slot] = there.wi.x();
                slots.y[slot] = there.wi.y();
                slots.z[slot] = there.wi.z();
                slots.distance[slot] = there.distance;
                slots.weight[slot] = there.wi ? there.L.r / there.pdf : 0.0;
            }
        });
    }
    in_vectors([&] {
        each([&](const Asker<View>& asker, std::size_t first) {
            if constexpr (is_cosines) {
                // Few look where faces are: the rest of the work is for those.
                const double* weights = slots.weight + first;
                if (std::count(weights, weights + lanes.count, 0.0) == lanes.count) {
                    pass_over(first);
                    return;
                }
            }
            aim_rays<is_far_away>(*asker.receiver, bvh, options, lanes.count, first, slots, fields,
                                  E);
        });
    });
    each([&](const Asker<View>& asker, std::size_t first) {
        if (asker.view.is_seen()) { return; }
        pass_over(first);
    });
    stream.resize(count);
}

template void draw(std::span<const Asker<RectDirections>>, const Bvh&, const TransportOptions&,
                   std::uint32_t, const Lanes&, ShadowStream&, Brought&);
template void draw(std::span<const Asker<RectView>>, const Bvh&, const TransportOptions&,
                   std::uint32_t, const Lanes&, ShadowStream&, Brought&);
template void draw(std::span<const Asker<DiskView>>, const Bvh&, const TransportOptions&,
                   std::uint32_t, const Lanes&, ShadowStream&, Brought&);
template void draw(std::span<const Asker<SphereView>>, const Bvh&, const TransportOptions&,
                   std::uint32_t, const Lanes&, ShadowStream&, Brought&);
template void draw(std::span<const Asker<SunView>>, const Bvh&, const TransportOptions&,
                   std::uint32_t, const Lanes&, ShadowStream&, Brought&);
template void draw(std::span<const Asker<CosineView>>, const Bvh&, const TransportOptions&,
                   std::uint32_t, const Lanes&, ShadowStream&, Brought&);
template void draw(std::span<const Asker<CosineDirections>>, const Bvh&, const TransportOptions&,
                   std::uint32_t, const Lanes&, ShadowStream&, Brought&);
template void draw(std::span<const Asker<DomeDirections>>, const Bvh&, const TransportOptions&,
                   std::uint32_t, const Lanes&, ShadowStream&, Brought&);
template void draw(std::span<const Asker<MeshDirections>>, const Bvh&, const TransportOptions&,
                   std::uint32_t, const Lanes&, ShadowStream&, Brought&);
template void draw(std::span<const Asker<MeshCosines>>, const Bvh&, const TransportOptions&,
                   std::uint32_t, const Lanes&, ShadowStream&, Brought&);

}  // namespace relight
