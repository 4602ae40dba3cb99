#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/base/rgb.h"
#include "core/base/vec.h"
#include "core/base/vectors.h"
#include "core/base/warp.h"

namespace relight {

/// How far about a map's pole a direction leads, 0 to 1: it has none of its own at the pole.
inline double turns_along(double x, double z)
{
    return 0.5 + std::copysign(warp::angle_above(std::abs(z), x), z) * (0.5 / std::numbers::pi);
}
/// The direction so far about the pole, at the height y.
inline Vec3 direction_at(double turns, double y)
{
    const warp::SineCosine phi = warp::sine_cosine_of_turns(turns - 0.5);
    const double across = std::sqrt(std::max(0.0, (1.0 - y) * (1.0 + y)));
    return {across * phi.cosine, y, across * phi.sine};
}

/// A map's texels and what they are drawn and found by, as loops over many directions copy it: no
/// branches or calls, so that compilers make vectors of those. Texels are numbered row by row, each
/// row filled up to whole blocks.
struct MapTables {
    /// Texels that stand together, and the sums of their row's luminances before and with them: all
    /// that a draw asks for comes with one access to memory.
    struct alignas(64) Block {
        static constexpr int texels = 4;
        float L[texels][3];
        double before, end;
    };

    int width, height;
    int blocks;                        ///< a row
    const float* L[Block::texels][3];  ///< of the first block: compilers gather by an index alone
    const double *before, *end;        ///< likewise
    /// What a number of [0, 1) is multiplied by to reach into a row: the double below its sum, so
    /// that none reaches beyond.
    const double* block_reach;
    const double* row_sums;  ///< from 0, running sums of luminance x solid angle
    double row_reach, total;
    /// The first row, or block of a row (two a word), that ends beyond where each of as many equal
    /// parts of [0, 1) begins. A power of two of parts: which one holds a number is told without
    /// rounding, so that no number falls before.
    const int* row_guide;
    const std::uint32_t* block_guide;
    int row_parts, block_parts;
    const double* edges;      ///< y of each row's upper edge, and of the last's lower
    const int* height_guide;  ///< rows by the part of the heights

    static constexpr int doubles = sizeof(Block) / sizeof(double);
    static constexpr int floats = sizeof(Block) / sizeof(float);

    int texels_a_row() const { return blocks * Block::texels; }

    /// The first step from `at` on that ends beyond t; that before `stop` does.
    static int settled(const double* ends, std::size_t apart, int at, int stop, double t)
    {
        const auto is_beyond = [&](int step) {
            return ends[static_cast<std::size_t>(step) * apart] > t;
        };
        if (is_beyond(at)) { return at; }
        int begin = at + 1, last = stop - 1;
        while (begin < last) {
            const int middle = begin + (last - begin) / 2;
            if (is_beyond(middle)) {
                last = middle;
            } else {
                begin = middle + 1;
            }
        }
        return last;
    }
    int settled_row(int row, double t) const { return settled(row_sums + 1, 1, row, height, t); }
    int settled_block(int row, int number, double t) const
    {
        return settled(end, doubles, number, (row + 1) * blocks, t);
    }
    /// Where to go on from for the row, and the block, that a number of [0, 1) reaches into to t:
    /// mostly there already.
    int near_row(double v, double t) const
    {
        int row = row_guide[static_cast<int>(v * row_parts)];
        row += row_sums[row + 1] <= t ? 1 : 0;
        return row + (row_sums[row + 1] <= t ? 1 : 0);
    }
    int near_block(int row, double u) const
    {
        const int part = row * block_parts + static_cast<int>(u * block_parts);
        const std::uint32_t two = block_guide[part / 2];
        const auto first = static_cast<int>((two >> (part % 2 * 16)) & 0xffffU);
        return row * blocks + first;
    }
    int nearer_block(int number, double t) const
    {
        return number + (end[static_cast<std::size_t>(number) * doubles] <= t ? 1 : 0);
    }
    /// Where in a step [0, 1], kept off its ends, where the rounding of a direction (and of its
    /// rotation) could carry it into a neighbour of another density.
    static double fraction(double within, double size)
    {
        constexpr double margin = 1e-7;
        const double all = std::max(0.0, std::min(1.0, within / size));
        return margin + (1.0 - 2.0 * margin) * all;
    }
    /// y of what falls in a row.
    double height_in(int row, double t) const
    {
        const double begin = row_sums[row], top = edges[row];
        return top + fraction(t - begin, row_sums[row + 1] - begin) * (edges[row + 1] - top);
    }
    /// A texel of a row's block, and how far across the map, 0 to 1.
    struct Across {
        int texel;
        double turns;
    };
    Across in_block(int row, int number, double t) const
    {
        const std::size_t of_block = static_cast<std::size_t>(number) * floats;
        const auto at = [&](int texel) {
            return luminance({static_cast<double>(L[texel][0][of_block]),
                              static_cast<double>(L[texel][1][of_block]),
                              static_cast<double>(L[texel][2][of_block])});
        };
        const double L0 = at(0), L1 = at(1), L2 = at(2), L3 = at(3);
        const double sum0 = before[static_cast<std::size_t>(number) * doubles];
        const double sum1 = sum0 + L0, sum2 = sum1 + L1, sum3 = sum2 + L2;
        const Mask past1 = where(sum1 <= t), past2 = where(sum2 <= t), past3 = where(sum3 <= t);
        const auto of = [&](double a0, double a1, double a2, double a3) {
            return choose(past3, a3, choose(past2, a2, choose(past1, a1, a0)));
        };
        const double texel = of(0.0, 1.0, 2.0, 3.0);
        const double column = (number - row * blocks) * Block::texels + texel;
        return {number * Block::texels + static_cast<int>(texel),
                (column + fraction(t - of(sum0, sum1, sum2, sum3), of(L0, L1, L2, L3))) / width};
    }
    Rgb radiance(int texel) const
    {
        // Sixteen floats for four texels, three a texel. An int: of a longer index no vectors.
        const int at = 4 * texel - (texel & 3);
        return {static_cast<double>(L[0][0][at]), static_cast<double>(L[0][1][at]),
                static_cast<double>(L[0][2][at])};
    }
    /// The part of the heights that y lies in: with the root of the distance from the pole rows are
    /// about as high everywhere, and no part holds more than one edge (two are apart by pi / 2
    /// parts at least).
    static int part_of_heights(int height, double y)
    {
        const double part = std::sqrt(std::max(0.0, 1.0 - std::abs(y))) * height;
        const double down = choose(where(y >= 0.0), part, 2.0 * height - part);
        return std::min(static_cast<int>(down), 2 * height - 1);
    }
    int row_along(double y) const
    {
        const int row = height_guide[part_of_heights(height, y)];
        return std::min(row + (edges[row + 1] >= y ? 1 : 0), height - 1);
    }
    /// The texel around the pole by so many turns, 0 to 1, at the height y.
    int texel_at(double turns, double y) const
    {
        // The seam's two names, 0 and 1, are one place.
        const int column = static_cast<int>(choose(where(turns < 1.0), turns, 0.0) * width);
        return row_along(y) * texels_a_row() + std::max(0, std::min(column, width - 1));
    }
};

}  // namespace relight
