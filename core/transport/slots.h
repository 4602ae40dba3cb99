#pragma once

#include <cmath>

#include "core/base/vectors.h"
#include "core/transport/draws.h"

/// Steps of draw(), each over the lanes of one asker from slot `first` on: loops in a form that
/// compilers turn into vectors, without a branch or a call. What they read once is copied first,
/// and the arrays are apart: what is written cannot be part of it.
namespace relight {

/// What is drawn, slot after slot of a stream. It is made in three steps, each over all slots: one
/// chain of a sample's operations alone would leave the processor waiting for its results.
struct Slots {
    static constexpr std::size_t most = RayFields::capacity + RayFields::spare;

    // Plain arrays: g++ 12 makes no vectors of what it reads from a const std::array.
    alignas(64) double u[most], v[most];           ///< the sample
    alignas(64) double x[most], y[most], z[most];  ///< the direction that it draws
    alignas(64) double distance[most];             ///< to the light
    alignas(64) double weight[most];               ///< radiance over density
};

/// Whole vectors of lanes, beyond the last too: there the next asker's go, or nothing.
constexpr unsigned whole(unsigned lanes)
{
    constexpr unsigned vector = RayFields::spare;
    return (lanes + vector - 1) / vector * vector;
}

/// The samples of one asker's lanes.
[[gnu::always_inline]] inline void draw_samples(const Sequence& of, std::uint32_t pair,
                                                const Lanes& lanes, std::size_t first, Slots& slots)
{
    const Sequence sequence = of;
    const unsigned count = whole(lanes.count);
    RELIGHT_APART
    for (unsigned i = 0; i < count; ++i) {
        const Sample2 s = sequence.replicate(lanes.replicate[i]).at(lanes.point[i], pair);
        slots.u[first + i] = s.u;
        slots.v[first + i] = s.v;
    }
}

/// The first of each pair alone.
[[gnu::always_inline]] inline void draw_picks(const Sequence& of, std::uint32_t pair,
                                              const Lanes& lanes, double* picks)
{
    const Sequence sequence = of;
    RELIGHT_APART
    for (unsigned i = 0; i < lanes.count; ++i) {
        picks[i] = sequence.replicate(lanes.replicate[i]).at(lanes.point[i], pair).u;
    }
}

/// The directions that they draw, and how bright the light is there over their density.
template <class View>
[[gnu::always_inline]] inline void draw_directions(const View& from, unsigned lanes,
                                                   std::size_t first, Slots& slots)
{
    const View view = from;
    const unsigned count = whole(lanes);
    // In two loops where it has two steps: half as long a chain keeps the processor twice as busy.
    constexpr bool in_steps = requires
    {
        view.corner(0.0);
    };
    if constexpr (in_steps) {
        RELIGHT_APART
        for (unsigned i = 0; i < count; ++i) {
            const std::size_t slot = first + i;
            const Vec3 corner = view.corner(slots.u[slot]);
            slots.x[slot] = corner.x;
            slots.y[slot] = corner.y;
            slots.z[slot] = corner.z;
        }
    }
    RELIGHT_APART
    for (unsigned i = 0; i < count; ++i) {
        const std::size_t slot = first + i;
        const Sample2 s{slots.u[slot], slots.v[slot]};
        const LightSample there = [&] {
            if constexpr (in_steps) {
                return view.toward({slots.x[slot], slots.y[slot], slots.z[slot]}, s);
            } else {
                return view.sample_direction(s);
            }
        }();
        slots.x[slot] = there.wi.x();
        slots.y[slot] = there.wi.y();
        slots.z[slot] = there.wi.z();
        slots.distance[slot] = there.distance;
        slots.weight[slot] = there.L.r / there.pdf;
    }
}

}  // namespace relight
