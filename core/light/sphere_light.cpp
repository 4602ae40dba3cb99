#include "core/light/sphere_light.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/warp.h"
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

/// `k` = 1 - cos of the angle between wi and the axis. The near root of |t wi - center| = R is
/// (d^2 - R^2) over the far one, a form without a difference of nearly equal lengths.
LightSample seen(const SphereLight& light, const Cone& cone, Dir3 wi, double k)
{
    const double R = light.radius, off = cone.d * std::sqrt(k * (2.0 - k));
    const double half_chord = std::sqrt(std::max(0.0, (R - off) * (R + off)));
    const double distance = (cone.d - R) * ((cone.d + R) / (cone.d * (1.0 - k) + half_chord));
    return {wi, distance, Rgb::grey(1.0), warp::cap_pdf(cone.height)};
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

LightSample sample(const SphereLight& light, Point3 p, Sample2 s)
{
    const Cone cone = cone_of(light, p);
    if (cone.height == 0.0) { return {}; }
    const Dir3 wi = normalize(frame_around(cone.axis).to_world(warp::cap(s, cone.height)));
    return seen(light, cone, wi, s.u * cone.height);
}

LightSample look(const SphereLight& light, Point3 p, Dir3 wi)
{
    const Cone cone = cone_of(light, p);
    const Vec3 aside = Vec3(wi) - cone.axis;
    const double k = 0.5 * dot(aside, aside);  // 1 - cos, of a narrow cone too
    if (cone.height == 0.0 || k > cone.height) { return {}; }
    return seen(light, cone, wi, k);
}

}  // namespace relight
