#include <cmath>
#include <numbers>

#include "core/bsdf/cook_torrance.h"
#include "core/bsdf/fresnel.h"
#include "core/check/cases.h"
#include "core/check/quadrature.h"

namespace relight {

void check_fresnel(Cases& cases)
{
    cases.group("Fresnel", "1");
    cases.relative("glass straight on", "F = ((n - 1) / (n + 1))^2", 0.04,
                   fresnel::dielectric(1.5, 1.0), 1e-12);
    cases.relative("gold straight on, n + ik = 0.18 + 3.42i",
                   "F = ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2)",
                   (0.82 * 0.82 + 3.42 * 3.42) / (1.18 * 1.18 + 3.42 * 3.42),
                   fresnel::conductor(0.18, 3.42, 1.0), 1e-12);
    cases.relative("glass from the side", "F -> 1", 1.0, fresnel::dielectric(1.5, 0.0), 1e-12);
    // At tan = n the parallel part vanishes, and reflected and refracted ray are at right angles.
    const double n = 1.5, rs = (n * n - 1.0) / (n * n + 1.0);
    cases.relative("glass at Brewster's angle", "F = ((n^2 - 1) / (n^2 + 1))^2 / 2", 0.5 * rs * rs,
                   fresnel::dielectric(n, std::cos(std::atan(n))), 1e-12);
    const double t = std::numbers::pi / 3.0, tt = std::asin(std::sin(t) / n);
    const double s = std::sin(t - tt) / std::sin(t + tt), p = std::tan(t - tt) / std::tan(t + tt);
    cases.relative("glass at 60 degrees", "F = (sin^2(a-b)/sin^2(a+b) + tan^2(a-b)/tan^2(a+b)) / 2",
                   0.5 * (s * s + p * p), fresnel::dielectric(n, std::cos(t)), 1e-12);
    const double out = 40.0 * std::numbers::pi / 180.0, ot = std::asin(n * std::sin(out));
    const double os = std::sin(ot - out) / std::sin(ot + out);
    const double op = std::tan(ot - out) / std::tan(ot + out);
    cases.relative("out of glass at 40 degrees, just before total reflection",
                   "F = (sin^2(a-b)/sin^2(a+b) + tan^2(a-b)/tan^2(a+b)) / 2",
                   0.5 * (os * os + op * op), fresnel::dielectric(1.0 / n, std::cos(out)), 1e-12);
    cases.relative("total reflection within glass at 60 degrees", "F = 1", 1.0,
                   fresnel::dielectric(1.0 / n, std::cos(t)), 1e-12);
    cases.relative("metal that absorbs nothing is glass", "F(n + 0i) = F(n)", 0.5 * (s * s + p * p),
                   fresnel::conductor(n, 0.0, std::cos(t)), 1e-9);
    const FresnelModel schlick = SchlickF0{Rgb::grey(0.1)};
    const double mean =
        quadrature::over_interval([&](double u) { return 2.0 * u * F(schlick, u).r; }, 0.0, 1.0, 4);
    cases.relative("mean of Schlick's approximation", "2 int F u du = (1 + 20 F0) / 21", 3.0 / 21.0,
                   mean, 1e-9);
}

}  // namespace relight
