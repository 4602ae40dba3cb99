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

    Rgb radiance(Vec3 w) const;    ///< along the unit direction w
    double pdf(Vec3 w) const;      ///< of sample(), lum(L) / sum(lum solid angle) [1/sr]
    Vec3 sample(Sample2 s) const;  ///< unit; {} if the map is black
    double luminance_integral() const { return total_; }  ///< sum of luminance x solid angle
    double texel_solid_angle(int row) const;              ///< exact: dphi (cos - cos)
    const Image& image() const { return image_; }
    /// No texel is brighter than twice the mean: looking about by the cosine then finds the light
    /// better than drawing texels does (and without noise where all are alike).
    bool is_even() const { return even_; }
    std::uint64_t bytes() const;

  private:
    std::size_t texel_along(Vec3 w) const;
    Image image_;
    std::vector<double> row_cdf_;    ///< running sums of luminance x solid angle, down the rows
    std::vector<double> texel_cdf_;  ///< and along each row, from 0 again
    double total_ = 0.0;
    bool even_ = false;
};

/// A sky at infinity. Power multiplies the map's radiance; without a map it is 1 everywhere.
struct EnvironmentLight {
    std::shared_ptr<const EnvironmentMap> map;
    double rotation = 0.0;  ///< about +Y, counter-clockwise seen from above [rad]
};
/// Constant skies are drawn uniformly over the sphere.
LightSample sample(const EnvironmentLight& light, Sample2 s);
LightSample look(const EnvironmentLight& light, Dir3 wi);

}  // namespace relight
