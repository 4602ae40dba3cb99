#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "core/base/camera.h"
#include "core/base/sobol.h"
#include "core/light/light_sample.h"

namespace relight {

/// Radiance from every direction, piecewise constant on an equirectangular grid: up is +Y,
/// u = 1/2 + atan2(z, x) / 2 pi across, v = acos(y) / pi down, row 0 at the zenith. Texels are
/// drawn with probability proportional to luminance times solid angle, and uniformly in solid angle
/// inside. Immutable.   Contract section 2. Test: Environment.*
class EnvironmentMap {
  public:
    /// `image`: at least 1 x 1, finite, not negative. Black is allowed (it then shines nowhere).
    explicit EnvironmentMap(Image image);

    /// What it shows along a direction.
    struct Seen {
        Vec3 w;  ///< unit
        Rgb L;
        double pdf;  ///< of sample(), lum(L) / sum(lum solid angle) [1/sr]
    };
    Seen sample(Sample2 s) const;                                ///< w = {} if the map is black
    Seen look(Vec3 w) const { return seen(texel_along(w), w); }  ///< w: unit
    /// look() in two steps, between which memory may be asked for.
    std::size_t texel_along(Vec3 w) const;
    Seen seen(std::size_t texel, Vec3 w) const;
    void fetch(std::size_t texel) const { __builtin_prefetch(&image_.pixels[texel]); }
    /// sample() in steps too. A place in one of the cells of [0, 1) by the sums of what they hold:
    /// `within` of its `size`, from its beginning.
    struct Cell {
        std::size_t index;
        double within, size;

        /// [0, 1], kept off the cell's edges, where the rounding of a direction (and of its
        /// rotation) could carry it into a neighbour of another density.
        double fraction() const
        {
            constexpr double margin = 1e-7;
            const double all = std::max(0.0, std::min(1.0, within / size));
            return margin + (1.0 - 2.0 * margin) * all;
        }
    };
    Cell draw_row(double v) const { return draw(row_cdf_, row_guide_, total_, v); }
    Cell draw_column(std::size_t row, double u) const
    {
        return draw(row_of(texel_cdf_, row), row_of(texel_guide_, row), row_sums_[row], u);
    }
    std::size_t guide_of_column(std::size_t row, double u) const
    {
        const auto width = static_cast<std::size_t>(image_.width);
        return row * width + guide_of(u, width);
    }
    void fetch_guide(std::size_t guide) const { __builtin_prefetch(&texel_guide_[guide]); }
    void fetch_sums(std::size_t row, std::size_t guide) const
    {
        __builtin_prefetch(&texel_cdf_[row * static_cast<std::size_t>(image_.width) +
                                       static_cast<std::size_t>(texel_guide_[guide])]);
    }
    /// y of a row's upper edge; of the last's lower: that of the row after it.
    double upper_edge(std::size_t row) const { return row_cos_[row]; }
    /// The texel around the pole by so many turns, 0 to 1, at the height y.
    std::size_t texel_at(double turns, double y) const;
    Rgb radiance(Vec3 w) const { return look(w).L; }
    double pdf(Vec3 w) const { return look(w).pdf; }
    double luminance_integral() const { return total_; }  ///< sum of luminance x solid angle
    double texel_solid_angle(int row) const;              ///< exact: dphi (cos - cos)
    const Image& image() const { return image_; }
    /// No texel is brighter than twice the mean: looking about by the cosine then finds the light
    /// better than drawing texels does (and without noise where all are alike).
    bool is_even() const { return even_; }
    std::uint64_t bytes() const;

  private:
    std::size_t row_along(double y) const;
    template <class T>
    std::span<const T> row_of(const std::vector<T>& all, std::size_t row) const
    {
        const auto width = static_cast<std::size_t>(image_.width);
        return std::span(all).subspan(row * width, width);
    }
    /// The guide of the part of the sums that u falls in.
    static std::size_t guide_of(double u, std::size_t sums)
    {
        const auto n = static_cast<double>(sums);
        return static_cast<std::size_t>(std::min(u * n, n - 1.0));
    }
    static Cell draw(std::span<const double> sums, std::span<const int> guide, double all,
                     double u);

    Image image_;
    std::vector<double> row_cdf_;    ///< running sums of luminance x solid angle, down the rows
    std::vector<double> texel_cdf_;  ///< and along each row, from 0 again
    std::vector<double>
        row_sums_;                 ///< the last of each of these rows: together, they stay in cache
    std::vector<double> row_cos_;  ///< y of each row's upper edge, and of the last's lower
    std::vector<int> row_guide_, texel_guide_;  ///< where to begin to look in the sums
    std::vector<int> height_guide_;             ///< and in row_cos_, by y from 1 to -1
    double total_ = 0.0;
    bool even_ = false;
};

/// A cell drawn in proportion to its step of the running sum, and where in the cell u fell.
/// `guide` holds for each of as many equal parts of [0, sums.back()] as there are sums, which sum
/// is the first beyond its beginning: on average the next one or two are looked at.
/// @param all sums.back()
inline EnvironmentMap::Cell EnvironmentMap::draw(std::span<const double> sums,
                                                 std::span<const int> guide, double all, double u)
{
    const double t = u * all;
    auto i = static_cast<std::size_t>(guide[guide_of(u, sums.size())]);
    // The first sum beyond t ends a step of more than 0; that u n was rounded up is mended.
    while (i > 0 && sums[i - 1] > t) { --i; }
    while (i < sums.size() && !(sums[i] > t)) { ++i; }
    // u < 1 may round up to the whole sum: then the first to reach it is the last such step.
    if (i == sums.size()) {
        i = static_cast<std::size_t>(std::lower_bound(sums.begin(), sums.end(), all) -
                                     sums.begin());
    }
    const double before = i == 0 ? 0.0 : sums[i - 1];
    return {i, t - before, sums[i] - before};
}

/// A sky at infinity. Power multiplies the map's radiance; without a map it is 1 everywhere.
struct EnvironmentLight {
    std::shared_ptr<const EnvironmentMap> map;
    double rotation = 0.0;  ///< about +Y, counter-clockwise seen from above [rad]
};
/// As any place sees it. Constant skies are drawn uniformly over the sphere.
class EnvironmentView {
  public:
    explicit EnvironmentView(const EnvironmentLight& light);  ///< its map outlives this

    LightSample sample(Sample2 s) const;
    LightSample look(Dir3 wi) const;
    Vec3 in_map(Dir3 wi) const;  ///< wi as the map has it

  private:
    const EnvironmentMap* map_;
    double cosine_, sine_;  ///< of its rotation
};
LightSample sample(const EnvironmentLight& light, Sample2 s);
LightSample look(const EnvironmentLight& light, Dir3 wi);

}  // namespace relight
