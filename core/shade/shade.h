#pragma once

#include <optional>
#include <vector>

#include "core/base/unset.h"
#include "core/transport/receiver.h"
#include "core/transport/transport.h"

namespace relight {

/// Per-vertex answers, linear, in the scene's units.
struct Shaded {
    UnsetVector<Rgbf> irradiance;      ///< V: E [W/m^2] or [lx], albedo-free, one-sided front face
    UnsetVector<Rgbf> radiance;        ///< V: Lo [W/(m^2 sr)] or [cd/m^2] toward the view
    UnsetVector<Rgbf> standard_error;  ///< V: of E; empty unless asked for
    std::vector<UnsetVector<Rgbf>> per_light;  ///< a light: V of E; empty unless asked for
};

struct ShadeOptions {
    bool radiance = true;
    bool per_light = false;
    bool standard_error = false;
    unsigned threads = 0;
};

/// E of one light at a vertex, bounces included. Shaded::irradiance is the sum of these over the
/// lights, in their order, rounded to float once: to the bit.
Rgb irradiance(const Column& column, Rgb power, std::size_t vertex);

/// What Shaded::radiance of one vertex is made of: `own`, then the lights in their order, summed
/// and rounded to float once, to the bit.
struct VertexRadiance {
    Rgb own;                     ///< what the material sends out by itself
    std::vector<Rgb> of_lights;  ///< one each of the scene; 0 where it is not enabled
};
/// `transport`: of this vertex alone (columns of one row), for which `materials` is
/// vertex_materials(). All 0 where no viewer sees the vertex.
VertexRadiance vertex_radiance(const Stage& stage, const Transport& transport, const Scene& scene,
                               std::span<const std::uint32_t> materials, std::size_t vertex);

/// columns x powers x material -> E and Lo. Sums run over the lights in their order, in double; f
/// of materials that are not Lambertian under delta lights is a float, by the kernels (kernels.h).
/// Empty if `progress` was stopped.
Shaded shade(const Stage& stage, const Transport& transport, const Scene& scene,
             const ShadeOptions& options, Progress& progress);

}  // namespace relight
