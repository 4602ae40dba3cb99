#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "core/base/parallel.h"
#include "core/scene.h"
#include "core/trace/stage.h"

namespace relight {

/// Share of a light that each vertex sees, 0..1. A delta light's is a bit.
struct Visibility {
    std::vector<float> share;         ///< V; empty where `bits` hold it
    std::vector<std::uint64_t> bits;  ///< that of vertex v is bit v % 64 of word v / 64

    float operator[](std::size_t v) const
    {
        return bits.empty() ? share[v] : static_cast<float>(bits[v / 64] >> (v % 64) & 1U);
    }
    bool operator==(const Visibility&) const = default;
};

/// What was traced for every vertex: of one light, what one unit of it delivers. Arrays of V x
/// bands values hold band after band of each vertex; those that were not asked for are empty.
struct Column {
    unsigned bands = 1;    ///< of E; 1: the same number for red, green and blue
    std::vector<float> E;  ///< V x bands: direct irradiance of unit power [1/m^2 sr or 1]
    Visibility visible;    ///< V: share of the light above the horizon that is unblocked (weighted
                           ///< by its cosine)
    std::vector<float> E_bounced;       ///< V x 3: after one bounce or more; empty without bounces
    std::vector<float> standard_error;  ///< V x bands (x 3 with bounces), of E + E_bounced; empty:
                                        ///< exact, no sample was drawn
    std::vector<float> Lo;              ///< V x 3: radiance toward the view
    std::vector<float> ambient_occlusion;  ///< V: cosine-weighted visibility of the sky
    std::vector<float> sh;                 ///< V x 9: int V cos Y_lm
    std::uint64_t rays = 0;                ///< traced for it
};
using SharedColumn = std::shared_ptr<const Column>;

/// What a column tells, and so what it depends on beside the mesh.
enum class Told {
    E,    ///< E, visibility and bounces of a light: where it stands; with bounces the albedo
    Lo,   ///< radiance that E does not tell, of materials that are not Lambertian under lights that
          ///< are no delta and by bounces: material and view besides
    Sky,  ///< ambient occlusion, with or without sh: no light
};

/// One column a light, in the scene's order; null for lights that are not enabled.
struct Transport {
    std::vector<SharedColumn> columns;  ///< Told::E
    std::vector<SharedColumn> drawn;    ///< Told::Lo; null where E tells all, or not asked for
    SharedColumn sky;                   ///< Told::Sky; null: not asked for
    std::uint64_t rays = 0;             ///< traced now: none for columns that were kept
};

/// Finds a column that has been made before, or has it made. Null: the making was stopped.
using Keep = std::function<SharedColumn(Told told, std::size_t light,
                                        const std::function<SharedColumn()>& make)>;

/// What is wanted beside E.
struct TransportWanted {
    bool radiance = false;  ///< Lo of materials that are not Lambertian
    bool ambient_occlusion = false;
    bool sh = false;
    unsigned threads = 0;
    Keep keep{};  ///< none: every column is made
};

/// The column of scene.lights[light] at the vertices [begin, end) alone. A pure function: any split
/// into ranges gives the same values.
Column column(const Stage& stage, const Scene& scene, std::size_t light, std::size_t begin,
              std::size_t end);

/// The same light's Column::Lo, for which `materials` is vertex_materials() (receiver.h). Empty
/// where E tells all.
Column drawn_radiance(const Stage& stage, const Scene& scene, std::size_t light, std::size_t begin,
                      std::size_t end, std::span<const std::uint32_t> materials);

/// Every enabled light's columns over all vertices. Stopped: what is there is not to be used.
Transport trace(const Stage& stage, const Scene& scene, const TransportWanted& wanted,
                Progress& progress);

}  // namespace relight
