#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/parallel.h"
#include "core/scene.h"
#include "core/trace/stage.h"

namespace relight {

/// What one unit of one light delivers to every vertex: depends on the mesh and on where the light
/// stands, not on its power, colour or on the material.
struct Column {
    std::vector<float> E;  ///< V: irradiance of unit power, shadows included [1/m^2 sr or 1]
    std::vector<std::uint8_t> visible;  ///< V: 1 where the light is above the surface and unblocked
    std::uint64_t rays = 0;             ///< traced for it
};

/// One column a light, in the scene's order; null for lights that are not enabled.
struct Transport {
    std::vector<std::shared_ptr<const Column>> columns;
    std::uint64_t rays = 0;
};

/// Direct light of one light at the vertices [begin, end) of the stage, as a column of that length.
/// A pure function: any split into ranges gives the same values.
Column direct_column(const Stage& stage, const Light& light, const TransportOptions& options,
                     double length_unit_m, std::size_t begin, std::size_t end);

/// Every enabled light's column over all vertices.
Transport trace(const Stage& stage, const Scene& scene, unsigned threads, Progress& progress);

}  // namespace relight
