#pragma once

#include <cstddef>
#include <span>

#include "core/shade/reflector.h"

/// The loops over vertices, in explicit SIMD for every instruction set, chosen at run time. Every
/// lane computes for itself, and tails run through the same instructions: a vertex gets the same
/// bytes alone and in any block, on any thread. Other instruction sets (with or without fused
/// multiply-add) may differ in the last bits.   Tests: Kernels.*
namespace relight::kernel {

/// Vertices of which a call knows something that is not the mesh's.
inline constexpr std::size_t block_size = 192;

/// Whence vertices are seen.
struct Viewer {
    enum class Place { AlongNormal, Direction, Point } place = Place::AlongNormal;
    double at[3]{};          ///< the direction to it, or its point
    bool two_sided = false;  ///< it sees the back too, unless it looks along the normal
};

/// The mesh's vertices (V x 3), and who sees them.
struct View {
    const double* positions = nullptr;
    const double* normals = nullptr;
    Viewer viewer;
};

/// One light's part in a sum: arrays as in Column, of all vertices.
struct Summand {
    const float* E = nullptr;
    const float* bounced = nullptr;  ///< may be null
    const float* error = nullptr;    ///< may be null
    unsigned E_bands = 1, error_bands = 1;
    double power[3]{};
    float* per_light = nullptr;  ///< V x 3: takes its share alone; may be null
};

/// What is made of them; arrays of V x 3 floats, of all vertices.
struct Sums {
    const Summand* lights = nullptr;
    std::size_t count = 0;
    float* E = nullptr;          ///< sum of power (E + bounced)
    float* error = nullptr;      ///< root of the sum of (power error)^2; may be null
    float* radiance = nullptr;   ///< sum of rho (power (E + bounced)) / pi; may be null
    const double* rho[3]{};      ///< with radiance: of the vertices from `begin` on
    const View* view = nullptr;  ///< with radiance: it is 0 where nobody sees the vertex
};

/// Sums of the vertices [begin, end), all in double, in the lights' order, rounded to float once,
/// nothing fused: to the bit what the same formulas in plain C++ give.
void add_columns(const Sums& sums, std::size_t begin, std::size_t end);

/// Whether the viewer is above the vertex: what add_columns() asks.
bool is_seen(const View& view, std::size_t vertex);

/// Where a delta light stands, or the direction to it.
struct Source {
    bool is_direction = false;
    double at[3]{};
};

/// One light's part in radiance; arrays of all vertices, null if it has none.
struct Share {
    double power[3]{};
    const float* Lo = nullptr;  ///< V x 3: drawn radiance
    const float* E = nullptr;   ///< V: a delta light's, from `source`
    Source source;
};

/// What is known of the vertices that are shaded together, an array an attribute.
struct Block {
    alignas(64) double rho[3][block_size];  ///< base colour
    alignas(64) double x[3][block_size];    ///< of the tangent frame; anisotropic materials' only
    alignas(64) double y[3][block_size];
    alignas(64) double L[3][block_size];  ///< radiance
    /// So many of the first vertices have one rho, and an L of 0: blocks that follow find them so.
    std::size_t of_one_rho = 0, dark = 0;
};

/// Of what material vertices are, who sees them, and by what they are lit.
struct Task {
    const Reflector* reflector = nullptr;
    const View* view = nullptr;
    bool both_sides = false;  ///< seen along its normal, the surface shows the light of either side
    std::span<const Share> lights;
    float* radiance = nullptr;  ///< V x 3: takes the sums, rounded; null: block.L does
};

/// block.L + sum over the lights, in their order, of power Lo + f (power E), in double: of `count`
/// vertices from `begin` on, at most a block. Cosines and what nearly cancels are formed in double
/// and then rounded, so that relative errors stay those of a float at grazing and for the narrowest
/// lobes. f is a float: 0 unless wi and wo are above the surface, never negative, nor anything but
/// a number.
void shine(Block& block, const Task& task, std::size_t begin, std::size_t count);

}  // namespace relight::kernel
