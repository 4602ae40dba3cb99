#pragma once

#include <array>
#include <cmath>

#include "core/base/sobol.h"
#include "core/light/light_sample.h"
#include "core/light/triangle.h"

namespace relight {

/// A flat rectangle (or parallelogram). Power is its radiance L; it shines toward u x v.
struct RectLight {
    Point3 center;
    Vec3 edge_u, edge_v;  ///< whole edges, scene units: corners are center +- u/2 +- v/2
    bool two_sided = false;
};

/// Of one side [scene units squared]. Flux is pi L A, twice that of a two-sided one.
double area(const RectLight& light);

/// E at p facing n from radiance 1 [sr].   Test: Polygon.ARectangle*
double irradiance(const RectLight& light, Point3 p, Dir3 n);

/// The rectangle as a place sees it. Drawn uniformly in the solid angle of the whole, that is of
/// its two triangles; "no direction" from behind, in its plane, or without area.
class RectView {
  public:
    RectView(const RectLight& light, Point3 p);

    /// Small halves are drawn by area, by other steps.
    bool by_area() const { return halves_[0].by_area || halves_[1].by_area; }
    LightSample sample(Sample2 s) const;
    LightSample look(Dir3 wi) const;

    /// What sample() gives where not by_area() and something is seen: without a branch.
    bool is_seen() const { return whole_ > 0.0; }
    LightSample sample_direction(Sample2 s) const
    {
        // s.u chooses the half and is then spread over it: points that are well apart stay so.
        const double at = s.u * whole_;
        // A blend by 0 and 1, which is exact: compilers make branches of a choice of so many.
        const SphericalTriangle &a = spherical_[0], &b = spherical_[1];
        const double other = 0.5 + std::copysign(0.5, at - a.solid_angle), one = 1.0 - other;
        SphericalTriangle half;
        half.solid_angle = a.solid_angle * one + b.solid_angle * other;
        half.A = a.A * one + b.A * other;
        half.B = a.B * one + b.B * other;
        half.T = a.T * one + b.T * other;
        half.sum = a.sum * one + b.sum * other;
        half.sine = a.sine * one + b.sine * other;
        half.b_dot_t = a.b_dot_t * one + b.b_dot_t * other;
        const double share = (at - a.solid_angle * other) / half.solid_angle;
        s.u = share < below_one ? share : below_one;
        const Vec3 wi = half.direction(s);
        const double distance = height_ / std::abs(dot(wi, normal_));
        // No farther than the farthest corner, whatever the rounding of a grazing direction.
        return {unit_already(wi), distance <= farthest_ ? distance : farthest_, Rgb::grey(1.0),
                1.0 / whole_};
    }

  private:
    static constexpr double below_one = 1.0 - 0x1p-33;
    std::array<TriangleView, 2> halves_;
    std::array<SphericalTriangle, 2> spherical_;  ///< where not by_area()
    double whole_ = 0.0;                          ///< solid angle; 0: nothing is to be seen
    Vec3 normal_;                                 ///< any length
    double height_ = 0.0;                         ///< above the plane, times that length
    double farthest_ = 0.0;                       ///< corner's distance
};

LightSample sample(const RectLight& light, Point3 p, Sample2 s);
LightSample look(const RectLight& light, Point3 p, Dir3 wi);

}  // namespace relight
