#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include "core/geometry/mesh.h"

namespace relight::test {

/// The same numbers on every machine.
class Draws {
  public:
    explicit Draws(std::uint32_t seed) : bits_(seed) {}
    double in(double lo, double hi)
    {
        return lo + (hi - lo) * 0x1p-32 * static_cast<double>(bits_());
    }
    double gauss()  // Box and Muller
    {
        const double r = std::sqrt(-2.0 * std::log(in(0.0, 1.0) + 0x1p-33));
        return r * std::cos(in(0.0, 2.0 * std::numbers::pi));
    }
    Dir3 direction()
    {
        const double z = in(-1, 1), azimuth = in(0.0, 2.0 * std::numbers::pi);
        const double r = std::sqrt(1.0 - z * z);
        return normalize({r * std::cos(azimuth), r * std::sin(azimuth), z});
    }

  private:
    std::mt19937 bits_;
};

/// A cloud of these places, without normals, doubles kept.
inline Mesh cloud_of(std::vector<Point3> positions)
{
    Mesh cloud;
    cloud.format = "test";
    cloud.positions = std::move(positions);
    cloud.double_positions = true;
    return cloud;
}

/// n places at random in [-1, 1]^2, z = 0.
inline std::vector<Point3> random_plane(std::size_t n, Draws& draws)
{
    std::vector<Point3> places;
    for (std::size_t i = 0; i < n; ++i) { places.push_back({draws.in(-1, 1), draws.in(-1, 1), 0}); }
    return places;
}

/// n places at random on the unit sphere.
inline std::vector<Point3> random_sphere(std::size_t n, Draws& draws)
{
    std::vector<Point3> places;
    for (std::size_t i = 0; i < n; ++i) { places.push_back(Point3{} + Vec3(draws.direction())); }
    return places;
}

}  // namespace relight::test
