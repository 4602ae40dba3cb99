#include "core/light/environment.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <span>

#include "core/base/warp.h"

namespace relight {
namespace {

constexpr double pi = std::numbers::pi;

/// The cell of [0, n) that t lies in, its upper end and rounding beyond either end included.
std::size_t cell(double t, int n)
{
    return static_cast<std::size_t>(t < n ? std::max(0, static_cast<int>(t)) : n - 1);
}

/// A cell drawn in proportion to its step of the running sum, and where in the cell t fell.
struct Drawn {
    std::size_t index;
    double fraction;  ///< [0, 1]
};
Drawn draw(std::span<const double> sums, double u)
{
    const double t = u * sums.back();
    // The first sum beyond t ends a step of more than 0. u < 1 may round up to the whole sum: then
    // the first to reach it is the last such step.
    auto it = std::upper_bound(sums.begin(), sums.end(), t);
    if (it == sums.end()) { it = std::lower_bound(sums.begin(), sums.end(), sums.back()); }
    const double before = it == sums.begin() ? 0.0 : *(it - 1);
    return {static_cast<std::size_t>(it - sums.begin()),
            std::clamp((t - before) / (*it - before), 0.0, 1.0)};
}

/// Keeps a place drawn in a texel off its edges, where the rounding of a direction (and of its
/// rotation) could carry it into a neighbour of another density.
double off_the_edges(double fraction)
{
    constexpr double margin = 1e-7;
    return margin + (1.0 - 2.0 * margin) * fraction;
}

/// Turned about +Y, counter-clockwise seen from above.
Vec3 turned(Vec3 w, double angle)
{
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * w.x + s * w.z, w.y, c * w.z - s * w.x};
}

}  // namespace

EnvironmentMap::EnvironmentMap(Image image) : image_(std::move(image))
{
    assert(image_.width > 0 && image_.height > 0 &&
           image_.pixels.size() == image_.at(0, image_.height));
    row_cdf_.reserve(static_cast<std::size_t>(image_.height));
    texel_cdf_.reserve(image_.pixels.size());
    for (int y = 0; y < image_.height; ++y) {
        const double Omega = texel_solid_angle(y);
        double row = 0.0;
        for (int x = 0; x < image_.width; ++x) {
            row += Omega * luminance(to_double(image_.pixels[image_.at(x, y)]));
            texel_cdf_.push_back(row);
        }
        total_ += row;
        row_cdf_.push_back(total_);
    }
    const double twice_the_mean = 2.0 * total_ / (4.0 * pi);
    even_ = std::all_of(image_.pixels.begin(), image_.pixels.end(), [&](const Rgbf& texel) {
        return luminance(to_double(texel)) <= twice_the_mean;
    });
}

double EnvironmentMap::texel_solid_angle(int row) const
{
    // cos a - cos b = 2 sin((a + b) / 2) sin((b - a) / 2), without its cancellation at the poles
    const double half = 0.5 * pi / image_.height;
    const double across = 2.0 * pi / image_.width;
    return across * 2.0 * std::sin((2.0 * row + 1.0) * half) * std::sin(half);
}

std::size_t EnvironmentMap::texel_along(Vec3 w) const
{
    const double u = 0.5 + std::atan2(w.z, w.x) / (2.0 * pi);
    // acos(y), with its digits near the poles and no limit to y
    const double v = std::atan2(std::hypot(w.x, w.z), w.y) / pi;
    // The seam's two names, u = 0 and u = 1, are one place.
    return cell(v * image_.height, image_.height) * static_cast<std::size_t>(image_.width) +
           cell(u < 1.0 ? u * image_.width : 0.0, image_.width);
}

Rgb EnvironmentMap::radiance(Vec3 w) const
{
    return to_double(image_.pixels[texel_along(w)]);
}

double EnvironmentMap::pdf(Vec3 w) const
{
    return total_ > 0.0 ? luminance(radiance(w)) / total_ : 0.0;
}

Vec3 EnvironmentMap::sample(Sample2 s) const
{
    if (!(total_ > 0.0)) { return {}; }
    const std::size_t width = static_cast<std::size_t>(image_.width);
    const Drawn row = draw(row_cdf_, s.v);
    const Drawn column = draw(std::span(texel_cdf_).subspan(row.index * width, width), s.u);

    const double phi =
        pi *
        (2.0 * (static_cast<double>(column.index) + off_the_edges(column.fraction)) / image_.width -
         1.0);
    const double step = pi / image_.height;
    const double top = std::cos(static_cast<double>(row.index) * step);
    const double bottom = std::cos(static_cast<double>(row.index + 1) * step);
    const double y = top + off_the_edges(row.fraction) * (bottom - top);
    const double sine = std::sqrt(std::max(0.0, (1.0 - y) * (1.0 + y)));
    return {sine * std::cos(phi), y, sine * std::sin(phi)};
}

std::uint64_t EnvironmentMap::bytes() const
{
    return image_.pixels.capacity() * sizeof(Rgbf) + image_.coverage.capacity() * sizeof(float) +
           (row_cdf_.capacity() + texel_cdf_.capacity()) * sizeof(double);
}

LightSample sample(const EnvironmentLight& light, Sample2 s)
{
    constexpr double sphere = 2.0;  // a cap as high as this is all of it
    const Vec3 w = light.map ? turned(light.map->sample(s), light.rotation) : warp::cap(s, sphere);
    return look(light, normalize(w));
}

LightSample look(const EnvironmentLight& light, Dir3 wi)
{
    LightSample seen;
    if (!wi) { return seen; }
    seen.wi = wi;
    if (light.map) {
        const Vec3 w = turned(wi, -light.rotation);
        seen.L = light.map->radiance(w);
        seen.pdf = light.map->pdf(w);
    } else {
        seen.L = Rgb::grey(1.0);
        seen.pdf = 0.25 * std::numbers::inv_pi;
    }
    return seen;
}

}  // namespace relight
