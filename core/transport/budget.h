#pragma once

#include <algorithm>
#include <cmath>

namespace relight {

/// Samples of a vertex under one light: `replicates` independent scrambles of the sequence with
/// `each` points. Within a replicate the points know of each other (that is what makes the error
/// fall faster than N^-1/2), so only the replicates' means say honestly how far off they are.
struct Budget {
    unsigned replicates = 2;
    unsigned each = 2;  ///< even: half by the light, half by the surface, where both are drawn

    unsigned samples() const { return replicates * each; }
};
inline constexpr unsigned most_replicates = 32;

/// About `samples` in all; at least 4, for an error needs two replicates. More replicates would
/// know their error better and err more: from 16 to 32 costs a tenth.
constexpr Budget budget_of(unsigned samples)
{
    constexpr unsigned few = 16;
    constexpr unsigned many_samples = 256;
    const unsigned replicates =
        samples >= many_samples ? most_replicates : std::clamp(samples / 2U, 2U, few);
    return {replicates, std::max(2U, samples / replicates & ~1U)};
}

/// Student's 97.5 % point over the normal one: with it, +-1.96 standard errors are a 95 % band for
/// so few replicates too. For the replicates that budget_of gives.
constexpr double student_factor(unsigned replicates)
{
    constexpr double t[] = {12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306,
                            2.262,  2.228, 2.201, 2.179, 2.160, 2.145, 2.131};
    constexpr double t_of_32 = 2.040;
    return (replicates <= 16 ? t[std::max(replicates, 2U) - 2] : t_of_32) / 1.960;
}

}  // namespace relight
