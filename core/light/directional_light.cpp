#include "core/light/directional_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/light/cap.h"

namespace relight {
namespace {

struct Disc {
    double sine, height;  ///< of its half angle: sin, 1 - cos

    explicit Disc(double half_angle)
    {
        const double angle = std::max(half_angle, 1e-60), half_sine = std::sin(0.5 * angle);
        sine = std::sin(angle);
        height = 2.0 * half_sine * half_sine;
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

SunView::SunView(const DirectionalLight& light) : frame_(frame_around(-light.travel))
{
    const Disc disc(light.half_angle);
    height_ = disc.height;
    L_ = std::numbers::inv_pi / (disc.sine * disc.sine);
}

LightSample SunView::look(Dir3 wi) const
{
    const Vec3 aside = Vec3(wi) - frame_.n;
    return 0.5 * dot(aside, aside) > height_ ? LightSample{} : seen(wi);
}

LightSample sample(const DirectionalLight& light, Sample2 s)
{
    return SunView(light).sample(s);
}

LightSample look(const DirectionalLight& light, Dir3 wi)
{
    return SunView(light).look(wi);
}

}  // namespace relight
