#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/camera.h"
#include "core/base/sobol.h"
#include "core/light/light_sample.h"
#include "core/light/map_tables.h"

namespace relight {

/// Radiance from every direction, piecewise constant on an equirectangular grid: up is +Y,
/// u = 1/2 + atan2(z, x) / 2 pi across, v = acos(y) / pi down, row 0 at the zenith. Texels are
/// drawn with probability proportional to luminance times solid angle, and uniformly in solid angle
/// inside. Immutable.   Contract section 2. Test: Environment.*
class EnvironmentMap {
  public:
    /// `image`: at least 1 x 1, finite, not negative; with rows filled up to fours less than 2^29
    /// texels. Black is allowed (it then shines nowhere).
    explicit EnvironmentMap(const Image& image);
    EnvironmentMap(EnvironmentMap&&) = default;  // what tables() tell stays where it is
    EnvironmentMap(const EnvironmentMap&) = delete;
    EnvironmentMap& operator=(EnvironmentMap&&) = delete;
    EnvironmentMap& operator=(const EnvironmentMap&) = delete;
    ~EnvironmentMap() = default;

    /// What it shows along a direction.
    struct Seen {
        Vec3 w;  ///< unit
        Rgb L;
        double pdf;  ///< of sample(), lum(L) / sum(lum solid angle) [1/sr]
    };
    Seen sample(Sample2 s) const;  ///< w = {} if the map is black
    Seen look(Vec3 w) const;       ///< w: unit
    Rgb radiance(Vec3 w) const { return look(w).L; }
    double pdf(Vec3 w) const { return look(w).pdf; }
    double luminance_integral() const { return tables_.total; }  ///< sum of luminance x solid angle
    double texel_solid_angle(int row) const;                     ///< exact: dphi (cos - cos)
    Image image() const;                                         ///< what it was made of, anew
    /// No texel is brighter than twice the mean: looking about by the cosine then finds the light
    /// better than drawing texels does (and without noise where all are alike).
    bool is_even() const { return even_; }
    const MapTables& tables() const { return tables_; }
    std::uint64_t bytes() const;

  private:
    Seen seen(int texel, Vec3 w) const;

    std::vector<MapTables::Block> blocks_;
    std::vector<double> block_reach_, row_sums_, edges_;
    std::vector<int> row_guide_, height_guide_;
    std::vector<std::uint32_t> block_guide_;
    MapTables tables_{};  ///< of these
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
