#pragma once

#include <vector>

#include "core/shade/eye_path.h"

namespace relight {

/// Adds to each path's sums the light that its place reflects toward it, straight from every light
/// and by way of up to scene.transport.bounces other surfaces. At each place delta lights are added
/// exactly; others are met in two ways, joined by the balance heuristic (Veach & Guibas 1995): by a
/// direction drawn from the light and by one drawn from the material, which the path then takes.
/// Unbiased: nothing is clamped or cut short.
void follow(const World& world, std::vector<EyePath> paths, RayQueue& queue);

}  // namespace relight
