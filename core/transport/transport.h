#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/scene.h"
#include "core/trace/stage.h"

namespace relight {

/// What one unit of one light delivers to every vertex. E depends on the mesh and on where the
/// light stands (and, with bounces, on the albedo); only Lo depends on the material and the view.
/// Arrays of V x bands values hold band after band of each vertex.
struct Column {
    unsigned bands = 1;    ///< 1: the same number for red, green and blue
    std::vector<float> E;  ///< V x bands: direct irradiance of unit power [1/m^2 sr or 1]
    /// V: share of the light above the horizon that is unblocked (weighted by its cosine), 0..1
    std::vector<float> visible;
    std::vector<float> E_bounced;       ///< V x 3: after one bounce or more; empty without bounces
    std::vector<float> standard_error;  ///< V x bands (x 3 with bounces), of E + E_bounced; empty:
                                        ///< exact, no sample was drawn
    /// V x 3: radiance toward the view that E does not tell: of materials that are not Lambertian,
    /// under lights that are no delta and by bounces. Empty: nothing of that kind.
    std::vector<float> Lo;
    std::uint64_t rays = 0;  ///< traced for it
};

/// One column a light, in the scene's order; null for lights that are not enabled.
struct Transport {
    std::vector<std::shared_ptr<const Column>> columns;
    std::vector<float> ambient_occlusion;  ///< V: cosine-weighted sky visibility; if asked for
    std::vector<float> sh;                 ///< V x 9: int V cos Y_lm; if asked for
    std::uint64_t rays = 0;
};

/// What is wanted beside E.
struct TransportWanted {
    bool radiance = false;  ///< Lo of materials that are not Lambertian
    bool ambient_occlusion = false;
    bool sh = false;
    unsigned threads = 0;
};

/// The column of scene.lights[light] at the vertices [begin, end) alone. A pure function: any split
/// into ranges gives the same values. `radiance`: with Lo, for which `materials` is
/// vertex_materials() (receiver.h).
Column column(const Stage& stage, const Scene& scene, std::size_t light, bool radiance,
              std::size_t begin, std::size_t end, std::span<const std::uint32_t> materials = {});

/// Every enabled light's column over all vertices.
Transport trace(const Stage& stage, const Scene& scene, const TransportWanted& wanted,
                Progress& progress);

}  // namespace relight
