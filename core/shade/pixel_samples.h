#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

#include "core/base/sobol.h"

namespace relight {

/// Places of side x side samples in a pixel, [0,1)^2: one in each cell of the grid, and one in each
/// of the side^2 columns and rows (correlated multi-jittered sampling, Kensler 2013). A function of
/// (seed, pixel, sample).
///
/// The cells are dealt out to `side` replicates of `side` samples, each with one cell in every
/// column and every row (a Latin square): whatever changes steadily across the pixel is the same
/// for each, so that the replicates' means differ by noise alone.
class PixelSamples {
  public:
    PixelSamples(int side, std::uint64_t seed)
        : side_(side),
          seed_(seed),
          across_(static_cast<std::size_t>(side)),
          down_(across_),
          shift_(across_)
    {
        // Rank of the multiples of the golden ratio: neighbouring rows are far apart.
        const auto place = [](int row) { return std::fmod(row * std::numbers::phi, 1.0); };
        for (int row = 0; row < side; ++row) {
            for (int other = 0; other < side; ++other) {
                shift_[static_cast<std::size_t>(row)] += place(other) < place(row) ? 1 : 0;
            }
        }
    }

    void move_to(std::uint64_t pixel)
    {
        key_ = sobol::mix(sobol::mix(0, seed_), pixel);
        shuffle(across_, 2);
        shuffle(down_, 3);
    }

    std::array<double, 2> at(int sample) const
    {
        const auto index = static_cast<std::uint64_t>(sample);
        const int x = sample % side_;
        const int y = sample / side_;
        const double fine_x = across_[static_cast<std::size_t>(y)] + number(index, 0);
        const double fine_y = down_[static_cast<std::size_t>(x)] + number(index, 1);
        return {(x + fine_x / side_) / side_, (y + fine_y / side_) / side_};
    }

    /// Which replicate a sample belongs to; within it, it is the one of its row.
    int replicate(int sample) const
    {
        return (sample % side_ + shift_[static_cast<std::size_t>(row(sample))]) % side_;
    }
    int row(int sample) const { return sample / side_; }

  private:
    /// uniform(seed, pixel, sample, dimension), bit for bit.
    double number(std::uint64_t sample, std::uint64_t dimension) const
    {
        return static_cast<double>(sobol::mix(sobol::mix(key_, sample), dimension) >> 11U) *
               0x1p-53;
    }

    void shuffle(std::vector<int>& order, std::uint64_t dimension) const
    {
        std::iota(order.begin(), order.end(), 0);
        for (std::size_t i = order.size(); i > 1; --i) {
            const double u = number(i, dimension);
            std::swap(order[i - 1], order[static_cast<std::size_t>(u * static_cast<double>(i))]);
        }
    }

    int side_;
    std::uint64_t seed_, key_ = 0;    ///< key: of the pixel
    std::vector<int> across_, down_;  ///< which fine column each row takes, which row each column
    std::vector<int> shift_;          ///< of the replicates along each row
};

}  // namespace relight
