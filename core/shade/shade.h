#pragma once

#include <vector>

#include "core/transport/transport.h"

namespace relight {

/// Per-vertex answers, linear, in the scene's units.
struct Shaded {
    std::vector<Rgbf> irradiance;  ///< V: E [W/m^2] or [lx], albedo-free, one-sided front face
    std::vector<Rgbf> radiance;    ///< V: Lo [W/(m^2 sr)] or [cd/m^2] toward the view
    std::vector<std::vector<Rgbf>> per_light;  ///< a light: V of E; empty unless asked for
};

struct ShadeOptions {
    bool radiance = true;
    bool per_light = false;
    unsigned threads = 0;
};

/// columns x powers x material -> E and Lo. Sums run over the lights in their order.
Shaded shade(const Stage& stage, const Transport& transport, const Scene& scene,
             const ShadeOptions& options, Progress& progress);

}  // namespace relight
