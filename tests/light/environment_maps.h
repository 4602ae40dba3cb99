#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "core/light/environment.h"
#include "tests/light/monte_carlo.h"

namespace relight::test {

inline Image image_of(int width, int height, const std::vector<Rgb>& pixels)
{
    Image image{width, height, {}, {}};
    for (const Rgb& c : pixels) { image.pixels.push_back(to_float(c)); }
    return image;
}

/// Numbers of very different size, some of them 0.
inline EnvironmentMap motley(int width, int height)
{
    std::vector<Rgb> pixels;
    for (int i = 0; i < width * height; ++i) {
        const auto u = [&](std::uint64_t k) {
            return uniform(7, 0, static_cast<std::uint64_t>(i), k);
        };
        pixels.push_back(u(0) < 0.25 ? Rgb{} : Rgb{u(1), u(2), u(3)} * std::pow(30.0, u(4)));
    }
    return EnvironmentMap(image_of(width, height, pixels));
}

inline Vec3 direction(double y, double phi)
{
    const double sine = std::sqrt((1.0 - y) * (1.0 + y));
    return {sine * std::cos(phi), y, sine * std::sin(phi)};
}

/// Edges of a row's cosine and of a column's azimuth, by the convention of the contract.
inline double row_edge(const Image& image, int row)
{
    return std::cos(std::numbers::pi * row / image.height);
}
inline double column_edge(const Image& image, int column)
{
    return 2.0 * std::numbers::pi * (static_cast<double>(column) / image.width - 0.5);
}
inline Vec3 centre(const Image& image, int column, int row)
{
    return direction(0.5 * (row_edge(image, row) + row_edge(image, row + 1)),
                     0.5 * (column_edge(image, column) + column_edge(image, column + 1)));
}

/// Integral of (a + b cos(phi))+ from phi0 to phi1, b >= 0, both within [-2 pi, 2 pi].
inline double positive_part(double a, double b, double phi0, double phi1)
{
    if (a <= -b) { return 0.0; }
    const double arc = a >= b ? std::numbers::pi : std::acos(-a / b);  // positive for |phi| < arc
    double sum = 0.0;
    for (const double turn : {-2.0 * std::numbers::pi, 0.0, 2.0 * std::numbers::pi}) {
        const double from = std::max(phi0, turn - arc), to = std::min(phi1, turn + arc);
        if (from < to) { sum += a * (to - from) + b * (std::sin(to) - std::sin(from)); }
    }
    return sum;
}

/// Integral of (n . w)+ over a texel: closed in phi, midpoints in theta.
inline double projected_solid_angle(const Image& image, int column, int row, Dir3 n, int steps)
{
    const double azimuth = std::atan2(n.z(), n.x());
    const double across = std::hypot(n.x(), n.z());
    const double step = std::numbers::pi / image.height / steps;
    double sum = 0.0;
    for (int i = 0; i < steps; ++i) {
        const double theta = std::numbers::pi * row / image.height + (i + 0.5) * step;
        sum += std::sin(theta) * positive_part(n.y() * std::cos(theta), across * std::sin(theta),
                                               column_edge(image, column) - azimuth,
                                               column_edge(image, column + 1) - azimuth);
    }
    return sum * step;
}

inline Rgb irradiance_by_texels(const EnvironmentMap& map, Dir3 n, int steps)
{
    const Image& image = map.image();
    Rgb E;
    for (int row = 0; row < image.height; ++row) {
        for (int column = 0; column < image.width; ++column) {
            E += map.radiance(centre(image, column, row)) *
                 projected_solid_angle(image, column, row, n, steps);
        }
    }
    return E;
}

/// Draws with the whole of pdf, map and light.
inline auto samples_of(const EnvironmentLight& light)
{
    return [light](Draw d) { return sample(light, d.s); };
}

}  // namespace relight::test
