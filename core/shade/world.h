#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "core/light/dome.h"
#include "core/scene.h"
#include "core/trace/stage.h"

namespace relight {

/// An enabled light as paths look for it.
struct Lamp {
    const Light* light = nullptr;
    std::size_t number = 0;  ///< in scene.lights
    bool delta = false;      ///< one direction alone brings its light
    bool shadowed = false;
    bool by_light = false;    ///< directions are drawn toward it,
    bool by_surface = false;  ///< and it is looked for where the surface reflects to
    bool in_parts = false;    ///< a random number picks the part that is drawn
    /// A ball that holds it; infinite where it is everywhere, or faces of the mesh.
    Point3 centre;
    double radius = 0.0;
    std::optional<Dome> dome;  ///< of a sky that is a map: many of its directions at once
};

/// Whether a ray from p along wi comes near the light: never no where look() sees it.
/// Test: MayBeSeen.*
bool may_be_seen(const Lamp& lamp, Point3 p, Dir3 wi);

/// The scene as paths see it.
struct World {
    const Stage& stage;
    const Scene& scene;
    std::vector<Lamp> lamps;
    bool any_by_surface = false;
    bool any_faces = false;  ///< some of them are faces of the mesh, found by the ray itself
};
World world_of(const Stage& stage, const Scene& scene);

/// What the lanes hold of direction `lane`.
inline LightSample sample_in(const DomeLanes& lanes, std::size_t lane)
{
    return {unit_already({lanes.x[lane], lanes.y[lane], lanes.z[lane]}),
            std::numeric_limits<double>::infinity(), lanes.seen.L(lane), lanes.seen.pdf[lane]};
}

/// take(i, there) of each of `count` directions in turn, wi(i), with what the dome shows there.
template <class Direction, class Take>
void look_along(const Dome& dome, std::size_t count, const Direction& wi, const Take& take)
{
    DomeLanes lanes;
    for (std::size_t begin = 0; begin < count; begin += DomeLanes::most) {
        const std::size_t some = std::min(DomeLanes::most, count - begin);
        for (std::size_t k = 0; k < some; ++k) {
            const Dir3 direction = wi(begin + k);
            lanes.x[k] = direction.x();
            lanes.y[k] = direction.y();
            lanes.z[k] = direction.z();
        }
        look(dome, some, lanes);
        for (std::size_t k = 0; k < some; ++k) { take(begin + k, sample_in(lanes, k)); }
    }
}

}  // namespace relight
