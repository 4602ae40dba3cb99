#pragma once

#include <array>
#include <functional>

#include "core/base/rgb.h"
#include "core/base/vec.h"

namespace relight {

/// A lobe of facets, f(wi, wo) with F = 1 [1/sr]; z is the normal.
using Mirror = std::function<double(Vec3 wi, Vec3 wo)>;

/// int f(wi, wo) cos_i dwi over the hemisphere: the share of light along wo (or of light that
/// leaves along it) that f accounts for. `alpha_x`, `alpha_y` are the widths of f's lobe of facets,
/// where the quadrature looks closely; wo.z > 0. About 0.1 ms; within 1e-5 of the integral.
/// Test: Multiscatter.AlbedoIs*
double directional_albedo(const Mirror& f, Vec3 wo, double alpha_x, double alpha_y);

/// Directional albedo of white facets (F = 1) over the view angle, and so what they lose: light
/// that left one facet only to meet another. Immutable; 3 to 15 ms to make, 50 for a stretched
/// lobe. Test: Multiscatter.*
class MultiscatterTable {
  public:
    /// Anisotropic lobes are averaged over the azimuth of wo, so that f_ms stays reciprocal.
    MultiscatterTable(const Mirror& mirror, double alpha_x, double alpha_y);

    double E(double cos_o) const;            ///< directional albedo, [0, 1]
    double E_avg() const { return E_avg_; }  ///< 2 int E mu dmu

    /// F_ms = F_avg^2 E_avg / (1 - F_avg (1 - E_avg)) a band: the share that comes out again after
    /// two facets or more, F_avg of it reflected at each.
    Rgb F_ms(Rgb F_avg) const;

    /// f_ms = F_ms (1 - E(cos_i)) (1 - E(cos_o)) / (pi (1 - E_avg)) [1/sr]: with F = 1 it returns
    /// 1 - E(cos_o), all that was lost.   Kulla & Conty 2017
    Rgb f_ms(double cos_i, double cos_o, Rgb F_avg) const;

    static constexpr int nodes = 48;
    /// The table itself: E at the cosines scale() sinh(reach() t^2), t = i / (nodes - 1), which
    /// crowd at grazing.
    const std::array<double, nodes>& E_at_nodes() const { return E_; }
    double scale() const { return scale_; }
    double reach() const { return reach_; }

  private:
    double cosine(double place) const;  ///< of a place among the nodes, 0 .. nodes - 1

    double scale_;  ///< cosine over which E turns: the width of the lobe
    double reach_;  ///< asinh(1 / scale)
    std::array<double, nodes> E_{};
    double E_avg_ = 1.0;
};

}  // namespace relight
