#pragma once

#include <cstddef>

#include "core/shade/reflector.h"

/// The loops over vertices, in explicit SIMD for every instruction set, chosen at run time. Every
/// lane computes for itself, and tails run through the same instructions: a vertex gets the same
/// bytes alone and in any block, on any thread. Other instruction sets (with or without fused
/// multiply-add) may differ in the last bits.   Tests: Kernels.*
namespace relight::kernel {

/// Vertices that are shaded together: what is known of them stays in the cache.
inline constexpr std::size_t block_size = 176;

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
    float* E = nullptr;         ///< sum of power (E + bounced)
    float* error = nullptr;     ///< root of the sum of (power error)^2; may be null
    float* radiance = nullptr;  ///< sum of rho (power (E + bounced)) / pi; may be null
    const double* rho[3]{};     ///< with radiance: of the vertices from `begin` on
};

/// Sums of the vertices [begin, end), all in double, in the lights' order, rounded to float once,
/// nothing fused: to the bit what the same formulas in plain C++ give.
void add_columns(const Sums& sums, std::size_t begin, std::size_t end);

/// Whence vertices are seen.
struct Viewer {
    enum class Place { AlongNormal, Direction, Point } place = Place::AlongNormal;
    double at[3]{};          ///< the direction to it, or its point
    bool two_sided = false;  ///< it sees the back too, unless it looks along the normal
};

/// A delta light: where it stands, or the direction to it.
struct Source {
    bool is_direction = false;
    double at[3]{};
};

/// Vertices that are seen, an array an attribute, and what falls on them from one light after the
/// other. Cosines and what nearly cancels are formed in double and then rounded: relative errors
/// stay those of a float at grazing and for the narrowest lobes.
struct Block {
    std::size_t count = 0;
    // In double: place, normal on the seen side, wo less its share along the normal, and its share.
    alignas(64) double p[3][block_size];
    alignas(64) double n[3][block_size];
    alignas(64) double wo[3][block_size];
    alignas(64) double cos_o[block_size];  ///< 0: not seen
    alignas(64) double x[3][block_size];   ///< axes of the lobes; only of anisotropic materials
    alignas(64) double y[3][block_size];
    alignas(64) double rho[3][block_size];  ///< base colour
    alignas(64) double L[3][block_size];    ///< radiance, summed
    // In float, what f depends on; h is wi + wo, not unit.
    alignas(64) float co[block_size];
    alignas(64) float ci[block_size];
    alignas(64) float h2[block_size];     ///< |h|^2 = 2 + 2 wi.wo
    alignas(64) float hxy2[block_size];   ///< of it, across the normal: |n x h|^2
    alignas(64) float along[block_size];  ///< wi.wo across the normal; Oren-Nayar's only
    alignas(64) float wi_x[block_size], wi_y[block_size];
    alignas(64) float wo_x[block_size], wo_y[block_size];
    alignas(64) float h_x[block_size], h_y[block_size];
    alignas(64) float base[3][block_size];   ///< rho
    alignas(64) float aside[4][block_size];  ///< what a model keeps of wo from light to light
    alignas(64) float f[3][block_size];      ///< [1/sr]
};

/// Vertices [begin, begin + block.count) of the mesh, whose positions and normals (V x 3) are
/// given: p, n, wo, cos_o.
void look(Block& block, const Viewer& viewer, const double* positions, const double* normals,
          std::size_t begin);

/// rho, 0 where the vertex is not seen.
void mask_rho(Block& block);

/// What f depends on beside wi, after rho, x, y and cos_o are there.
void prepare(Block& block, const Reflector& reflector);
void round_wo(Block& block, bool anisotropic);  ///< the first step of it: co, base, wo_x, wo_y

/// What a model wants to know across the normal: `along`; h2, hxy2; or these and along the axes.
enum class Across { Along, Half, Axes };
void face(Block& block, const Source& source, bool both_sides, Across across);

/// f of light from `source`: for both sides of the surface alike if `both_sides`. 0 unless wi and
/// wo are above the surface; never negative, nor anything but a number.
void reflect(Block& block, const Reflector& reflector, const Source& source, bool both_sides);

/// L += power Lo + f (power E), in double and in this order. `Lo` (V x 3) or `E` (V) may be null:
/// then without.
void add_light(Block& block, const double (&power)[3], const float* Lo, const float* E,
               std::size_t begin);

/// Rounds L to V x 3 floats.
void store(const Block& block, float* radiance, std::size_t begin);

}  // namespace relight::kernel
