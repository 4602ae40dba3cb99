#include "core/light/ies.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <span>

namespace relight {
namespace {

constexpr double degree = std::numbers::pi / 180.0;

/// The horizontal angle at which the web is tabulated. Mirrors leave every symmetric web alone:
/// 0..90 has both of them, 0..180 the plane through 0 and 180, 90..270 that through 90 and 270.
double folded(const IesProfile& profile, double horizontal_deg)
{
    const double first = profile.horizontal_deg.front(), last = profile.horizontal_deg.back();
    double h = std::fmod(horizontal_deg, 360.0);
    if (h < 0.0) { h += 360.0; }
    if (first == 90.0 && last == 270.0) {
        if (h < 90.0) { return 180.0 - h; }
        return h > 270.0 ? 540.0 - h : h;
    }
    if (last <= 180.0 && h > 180.0) { h = 360.0 - h; }
    if (last <= 90.0 && h > 90.0) { h = 180.0 - h; }
    return h;
}

/// Between knots i and j of ascending angles, a share t on from i.
struct Place {
    std::size_t i, j;
    double t;
};
Place place(std::span<const double> angles, double x)
{
    const auto above = std::upper_bound(angles.begin(), angles.end(), x);
    const std::size_t j = static_cast<std::size_t>(above - angles.begin());
    if (j == 0) { return {0, 0, 0.0}; }
    if (j == angles.size()) { return {j - 1, j - 1, 0.0}; }
    return {j - 1, j, (x - angles[j - 1]) / (angles[j] - angles[j - 1])};
}

double mix(double a, double b, double t)
{
    return a + (b - a) * t;
}

}  // namespace

double intensity(const IesProfile& profile, double vertical_deg, double horizontal_deg)
{
    const std::vector<double>& angles = profile.vertical_deg;
    assert(profile.candela.size() == angles.size() * profile.horizontal_deg.size());
    if (!(vertical_deg >= angles.front() && vertical_deg <= angles.back())) { return 0.0; }
    const Place v = place(angles, vertical_deg);
    const Place h = place(profile.horizontal_deg, folded(profile, horizontal_deg));
    const auto half_plane = [&](std::size_t row) {
        const double* candela = profile.candela.data() + row * angles.size();
        return mix(candela[v.i], candela[v.j], v.t);
    };
    return mix(half_plane(h.i), half_plane(h.j), h.t);
}

double flux(const IesProfile& profile)
{
    const std::vector<double>& horizontal = profile.horizontal_deg;
    const std::vector<double>& vertical = profile.vertical_deg;
    // I averaged over the horizontal angle: the trapezoid rule is exact, and a mirrored part has
    // the average of the tabulated one.
    const double span = horizontal.back() - horizontal.front();
    const auto mean = [&](std::size_t v) {
        const auto candela = [&](std::size_t h) {
            return profile.candela[h * vertical.size() + v];
        };
        if (span == 0.0) { return candela(0); }
        double sum = 0.0;
        for (std::size_t h = 1; h < horizontal.size(); ++h) {
            sum += 0.5 * (candela(h - 1) + candela(h)) * (horizontal[h] - horizontal[h - 1]);
        }
        return sum / span;
    };
    // Over a piece where I is linear: integral of I sin = [-I cos] + I' [sin].
    double Phi = 0.0;
    for (std::size_t v = 1; v < vertical.size(); ++v) {
        const double a = vertical[v - 1] * degree, b = vertical[v] * degree;
        if (a == b) { continue; }
        const double I_a = mean(v - 1), I_b = mean(v);
        Phi += I_a * std::cos(a) - I_b * std::cos(b) +
               (I_b - I_a) / (b - a) * (std::sin(b) - std::sin(a));
    }
    return std::max(0.0, 2.0 * std::numbers::pi * Phi);
}

double intensity_toward(const IesLight& light, Dir3 wi)
{
    const Vec3 w = -wi;  // from the light
    const Vec3 axis = light.axis;
    const Dir3 x = normalize(Vec3(light.h0) - axis * dot(light.h0, axis));
    const Vec3 y = cross(-axis, x);
    // atan2 keeps the digits that acos loses at the axis.
    const double vertical = std::atan2(length(cross(axis, w)), dot(axis, w));
    const double horizontal = std::atan2(dot(w, y), dot(w, x));
    return intensity(*light.profile, vertical / degree, horizontal / degree);
}

}  // namespace relight
