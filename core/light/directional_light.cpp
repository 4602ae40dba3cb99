#include "core/light/directional_light.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/base/warp.h"
#include "core/light/cap.h"

namespace relight {
namespace {

/// The disc of the sky that is drawn from. One narrower than 1e-60 rad has no room for its radiance
/// in double and shines as one of that width.
struct Disc {
    double sine, height;  ///< of its half angle: sin, 1 - cos

    explicit Disc(double half_angle)
    {
        const double angle = std::max(half_angle, 1e-60), half_sine = std::sin(0.5 * angle);
        sine = std::sin(angle);
        height = 2.0 * half_sine * half_sine;
    }
    LightSample seen(Dir3 wi) const
    {
        const double L = std::numbers::inv_pi / (sine * sine);
        return {wi, std::numeric_limits<double>::infinity(), Rgb::grey(L), warp::cap_pdf(height)};
    }
};

}  // namespace

double irradiance(const DirectionalLight& light, Dir3 n)
{
    const double cos_beta = dot(n, -light.travel);
    if (light.half_angle == 0.0) { return std::max(0.0, cos_beta); }
    const double sine = Disc(light.half_angle).sine;
    return cap_irradiance(sine, cos_beta) / (std::numbers::pi * sine * sine);
}

LightSample sample(const DirectionalLight& light, Sample2 s)
{
    const Disc disc(light.half_angle);
    const Frame frame = frame_around(-light.travel);
    return disc.seen(normalize(frame.to_world(warp::cap(s, disc.height))));
}

LightSample look(const DirectionalLight& light, Dir3 wi)
{
    const Disc disc(light.half_angle);
    const Vec3 aside = Vec3(wi) + light.travel;
    if (0.5 * dot(aside, aside) > disc.height) { return {}; }
    return disc.seen(wi);
}

}  // namespace relight
