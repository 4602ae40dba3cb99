#pragma once

#include <span>

#include "core/shade/eye_path.h"

namespace relight {

/// At each path's place: light by directions that the lights choose, joined with the ways that
/// paths take (paths.h) by the balance heuristic.
void ask_lights(const World& world, const Dimensions& dimensions, std::span<const EyePath> paths,
                RayQueue& queue);

}  // namespace relight
