#include "core/light/sphere_light.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/light/cap.h"

namespace relight {
namespace {

/// The ball as p sees it.
struct Cone {
    Dir3 axis;
    double d = 0.0;       ///< to the centre
    double height = 0.0;  ///< 1 - cos of its half angle; 0: nothing is to be seen
};

Cone cone_of(const SphereLight& light, Point3 p)
{
    const Vec3 to_center = light.center - p;
    const double d = length(to_center), R = light.radius;
    if (!(d > R)) { return {}; }
    const double sine = R / d;
    // 1 - cos = sin^2 / (1 + cos), which keeps the digits of a small or far ball.
    const double cosine = std::sqrt((1.0 - sine) * (1.0 + sine));
    const double height = sine * sine / (1.0 + cosine);
    if (height < std::numeric_limits<double>::min()) { return {}; }  // its density overflows
    return {normalize(to_center), d, height};
}

}  // namespace

double area(const SphereLight& light)
{
    return 4.0 * std::numbers::pi * light.radius * light.radius;
}

double irradiance(const SphereLight& light, Point3 p, Dir3 n)
{
    const Cone cone = cone_of(light, p);
    if (cone.height == 0.0) { return 0.0; }
    return cap_irradiance(light.radius / cone.d, dot(n, cone.axis));
}

SphereView::SphereView(const SphereLight& light, Point3 p)
{
    const Cone cone = cone_of(light, p);
    if (cone.height == 0.0) { return; }
    frame_ = frame_around(cone.axis);
    R_ = light.radius;
    d_ = cone.d;
    height_ = cone.height;
}

LightSample SphereView::look(Dir3 wi) const
{
    const Vec3 aside = Vec3(wi) - frame_.n;
    const double k = 0.5 * dot(aside, aside);  // 1 - cos, of a narrow cone too
    if (!is_seen() || k > height_) { return {}; }
    return seen(wi, k * (2.0 - k), 1.0 - k);
}

LightSample sample(const SphereLight& light, Point3 p, Sample2 s)
{
    return SphereView(light, p).sample(s);
}

LightSample look(const SphereLight& light, Point3 p, Dir3 wi)
{
    return SphereView(light, p).look(wi);
}

}  // namespace relight
