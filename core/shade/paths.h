#pragma once

#include <cstdint>
#include <vector>

#include "core/base/sobol.h"
#include "core/shade/seen.h"
#include "core/transport/gather.h"

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
};

/// Whether a ray from p along wi comes near the light: never no where look() sees it.
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

/// A path that comes from the eye, at a place where it looks for light.
struct EyePath {
    Seen seen;
    Rgb weight = Rgb::grey(1.0);  ///< share of the light found here that reaches the eye
    Rgb* sums = nullptr;          ///< where it is added: one of scene.lights each
    Sequence sequence;
    std::uint32_t point = 0;  ///< of the sequence
};

/// Adds to each path's sums the light that its place reflects toward it, straight from every light
/// and by way of up to scene.transport.bounces other surfaces. At each place delta lights are added
/// exactly; others are met in two ways, joined by the balance heuristic (Veach & Guibas 1995): by a
/// direction drawn from the light and by one drawn from the material, which the path then takes.
/// Unbiased: nothing is clamped or cut short.
void follow(const World& world, std::vector<EyePath> paths, RayQueue& queue);

}  // namespace relight
