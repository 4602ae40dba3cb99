#pragma once

#include <cmath>

#include "core/base/warp.h"
#include "core/light/light_sample.h"

namespace relight {

/// A flat disk. Power is its radiance L; it shines on the side of `normal`.
struct DiskLight {
    Point3 center;
    Dir3 normal;
    double radius = 0.0;  ///< scene units
};

/// Of the side that shines [scene units squared]. Flux is pi L A.
double area(const DiskLight& light);

/// E at p facing n from radiance 1 [sr], in closed form also where the horizon cuts the disk; 0
/// from behind it and in its plane.   Test: DiskLight.*
double irradiance(const DiskLight& light, Point3 p, Dir3 n);

/// The disk as a place sees it fills an elliptic cone. Its axis z halves the angle NpF between the
/// nearest and the farthest point of the rim, y lies across, and on the plane z = 1 the ellipse has
/// the semi-axes a = tan(NpF / 2) = 2 R h / P along x and b = R sqrt(2 / P) along y.
/// (Guillen et al. 2017 have the ellipse; the map below is ours.)
///
/// A direction is drawn by its azimuth, then by its cosine, which is uniform from the axis to the
/// rim. The rim's azimuth phi (a cos, b sin) would need the density W(phi) = 1 / (s^2 + s),
/// s^2 = 1 + a^2 cos^2 + b^2 sin^2, an elliptic integral; 1 / s^2 lies within a factor of two of
/// it and integrates to an arc tangent. So the density is a constant times 1 + 1 / s: uniform in
/// solid angle within a factor of two everywhere (and exactly where the disk looks small), and no
/// receiver is too near.
class DiskView {
  public:
    DiskView(const DiskLight& light, Point3 p);

    LightSample sample(Sample2 s) const { return is_seen() ? sample_direction(s) : LightSample{}; }
    LightSample look(Dir3 wi) const;

    bool is_seen() const { return density_ > 0.0; }
    /// sample() where something is seen: without a branch.
    LightSample sample_direction(Sample2 s) const
    {
        const Vec3 d = warp::disk(s);  // its azimuth is uniform, and the square of its length
        const double x = stretch_x_ * d.x, y = stretch_y_ * d.y;
        const double q = rim2(x, y), secant = std::sqrt(1.0 + q);
        const double share = d.x * d.x + d.y * d.y;
        // 1 - cos, its share of the rim's; so near to the disk that q overflows, of 1
        const double k = share * (q < 1e300 ? q / (secant * (secant + 1.0)) : 1.0);
        const double across2 = x * x + y * y;
        const double sine = std::sqrt(across2 > 0.0 ? k * (2.0 - k) / across2 : 0.0);
        return seen(unit_already(frame_.to_world({x * sine, y * sine, 1.0 - k})), secant);
    }

  private:
    /// tan^2 of the rim's angle from the axis in the direction (x, y).
    double rim2(double x, double y) const
    {
        const double across2 = x * x + y * y;
        const double inverse = x * x * per_a2_ + y * y * per_b2_;
        return across2 > 0.0 ? across2 / inverse : 1.0 / per_a2_;
    }
    LightSample seen(Dir3 wi, double secant) const
    {
        const double down = -dot(wi, normal_);
        // No farther than the rim, whatever the rounding of a grazing direction.
        const double distance = down * farthest_ > height_ ? height_ / down : farthest_;
        return {wi, distance, Rgb::grey(1.0), density_ * (1.0 + 1.0 / secant)};
    }

    Frame frame_;
    Vec3 normal_;
    double height_ = 0.0, farthest_ = 0.0;
    double per_a2_ = 0.0, per_b2_ = 0.0, stretch_x_ = 0.0, stretch_y_ = 0.0;
    double density_ = 0.0;  ///< 0: nothing is to be seen
};

LightSample sample(const DiskLight& light, Point3 p, Sample2 s);
LightSample look(const DiskLight& light, Point3 p, Dir3 wi);

}  // namespace relight
