#pragma once

#include <algorithm>
#include <cmath>

#include "core/base/warp.h"
#include "core/light/light_sample.h"

namespace relight {

/// A ball that shines outward. Power is its radiance L.
struct SphereLight {
    Point3 center;
    double radius = 0.0;  ///< scene units
};

/// [scene units squared]. Flux is pi L A.
double area(const SphereLight& light);

/// E at p facing n from radiance 1 [sr]; 0 within the ball.   Test: SphereLight.*
double irradiance(const SphereLight& light, Point3 p, Dir3 n);

/// The ball as a place sees it: a cone, drawn uniformly in solid angle. Distances are those of its
/// near side.
class SphereView {
  public:
    SphereView(const SphereLight& light, Point3 p);

    LightSample sample(Sample2 s) const { return is_seen() ? sample_direction(s) : LightSample{}; }
    LightSample look(Dir3 wi) const;

    bool is_seen() const { return height_ > 0.0; }
    /// sample() where something is seen: without a branch.
    LightSample sample_direction(Sample2 s) const
    {
        const Vec3 local = warp::cap(s, height_);
        const double across2 = local.x * local.x + local.y * local.y;
        return seen(unit_already(frame_.to_world(local)), across2, local.z);
    }

  private:
    /// The near root of |t wi - center| = R is (d^2 - R^2) over the far one, a form without a
    /// difference of nearly equal lengths.
    LightSample seen(Dir3 wi, double sine2, double cosine) const
    {
        const double off = d_ * std::sqrt(sine2);
        const double half_chord = std::sqrt(std::max(0.0, (R_ - off) * (R_ + off)));
        const double distance = (d_ - R_) * ((d_ + R_) / (d_ * cosine + half_chord));
        return {wi, distance, Rgb::grey(1.0), warp::cap_pdf(height_)};
    }

    Frame frame_;
    double R_ = 0.0;
    double d_ = 0.0;       ///< to the centre
    double height_ = 0.0;  ///< 1 - cos of the cone's half angle; 0: nothing is to be seen
};

LightSample sample(const SphereLight& light, Point3 p, Sample2 s);
LightSample look(const SphereLight& light, Point3 p, Dir3 wi);

}  // namespace relight
