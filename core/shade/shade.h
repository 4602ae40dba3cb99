#pragma once

#include <vector>

#include "core/transport/receiver.h"
#include "core/transport/transport.h"

namespace relight {

/// Per-vertex answers, linear, in the scene's units.
struct Shaded {
    std::vector<Rgbf> irradiance;      ///< V: E [W/m^2] or [lx], albedo-free, one-sided front face
    std::vector<Rgbf> radiance;        ///< V: Lo [W/(m^2 sr)] or [cd/m^2] toward the view
    std::vector<Rgbf> standard_error;  ///< V: of E; empty unless asked for
    std::vector<std::vector<Rgbf>> per_light;  ///< a light: V of E; empty unless asked for
};

struct ShadeOptions {
    bool radiance = true;
    bool per_light = false;
    bool standard_error = false;
    unsigned threads = 0;
};

/// E of one light at a vertex, bounces included. Shaded::irradiance is the sum of these over the
/// lights, in their order, rounded to float once.
Rgb irradiance(const Column& column, Rgb power, std::size_t vertex);

/// Radiance toward its viewer that a vertex owes to one light. Shaded::radiance is the emission of
/// a front that is seen plus the sum of these over the lights, in their order, rounded once.
Rgb radiance(const SeenVertex& seen, const Scene& scene, const Material& material, Rgb color,
             const Column& column, const Light& light, std::size_t vertex);

/// What the material sends out by itself toward the viewer: the seen vertex' front alone shines.
Rgb own_light(const SeenVertex& seen, const Stage& stage, const Material& material,
              std::size_t vertex);

/// columns x powers x material -> E and Lo. Sums run over the lights in their order.
Shaded shade(const Stage& stage, const Transport& transport, const Scene& scene,
             const ShadeOptions& options, Progress& progress);

}  // namespace relight
