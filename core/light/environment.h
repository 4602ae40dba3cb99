#pragma once

#include <memory>
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
    /// sample() and texel_along() in steps too.
    struct Cell {
        std::size_t index;
        double fraction;  ///< within it, [0, 1]
    };
    Cell draw_row(double v) const;
    Cell draw_column(std::size_t row, double u) const;
    std::size_t guide_of_column(std::size_t row, double u) const;
    void fetch_guide(std::size_t guide) const { __builtin_prefetch(&texel_guide_[guide]); }
    void fetch_sums(std::size_t row, std::size_t guide) const
    {
        __builtin_prefetch(&texel_cdf_[row * static_cast<std::size_t>(image_.width) +
                                       static_cast<std::size_t>(texel_guide_[guide])]);
    }
    double turns(std::size_t column, double fraction) const;  ///< about the pole, -1/2 to 1/2
    double height(Cell row) const;                            ///< y
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
    Image image_;
    std::vector<double> row_cdf_;    ///< running sums of luminance x solid angle, down the rows
    std::vector<double> texel_cdf_;  ///< and along each row, from 0 again
    std::vector<double> row_cos_;    ///< y of each row's upper edge, and of the last's lower
    std::vector<int> row_guide_, texel_guide_;  ///< where to begin to look in the sums
    std::vector<int> height_guide_;             ///< and in row_cos_, by y from 1 to -1
    double total_ = 0.0;
    bool even_ = false;
};

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
