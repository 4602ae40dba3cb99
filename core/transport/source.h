#pragma once

#include <cstdint>

#include "core/base/sobol.h"
#include "core/trace/bvh.h"
#include "core/transport/receiver.h"

namespace relight {

/// Pairs of dimensions of a sequence, by what they decide.
enum Pair : std::uint32_t {
    light_pair,
    light_pick,
    response_pair,
    response_pick,
    path_pair,
    path_pick,
    first_bounce,  // and three for each: where light is looked for, its pick, where the path goes
};
inline constexpr std::uint32_t pairs_per_bounce = 3;

/// The vertex's part of its random numbers' key: where it is and which way it faces, so that
/// neither the order of the vertices nor a duplicate changes an answer.
std::uint64_t key_of(const Receiver& receiver);

/// One light as the transport sees it: whose column is being made.
struct Source {
    const Stage& stage;
    const Scene& scene;
    const Light& light;
    std::uint64_t number = 0;  ///< part of the random numbers' key

    bool shadowed() const { return scene.transport.shadows && light.cast_shadows; }
    /// Replicate 0 of a receiver's.
    Sequence sequence(const Receiver& receiver) const
    {
        return {scene.transport.seed, key_of(receiver), number, 0};
    }
};

/// A sky that is found by looking about, not by drawing it.
bool is_even_sky(const LightShape& shape);

/// The ray that says whether a light's sample is seen; toward a shining face it stops before it.
ShadowRay ray_toward(const Source& source, const Receiver& receiver, const LightSample& there);

}  // namespace relight
