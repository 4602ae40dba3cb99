#pragma once

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "core/base/rgb.h"
#include "core/base/vec.h"

namespace relight {

/// A pinhole camera; looks along target - eye, row 0 on top.
struct Camera {
    Point3 eye;
    Point3 target;
    Vec3 up{0, 1, 0};
    double fov_y{40.0 * std::numbers::pi / 180.0};  ///< [rad]
};

/// The camera's right-handed axes in world space: it looks along -back.
struct CameraAxes {
    Dir3 right, up, back;
};

/// Axes of a camera; an `up` along the view is replaced by the axis that is least along it.
inline CameraAxes axes(const Camera& camera)
{
    const Dir3 back = normalize(camera.eye - camera.target);
    Dir3 right = normalize(cross(normalize(camera.up), back));
    if (!right || length(cross(normalize(camera.up), back)) < 1e-9) {
        const Vec3 other = std::abs(back.x()) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 0, 1};
        right = normalize(cross(other, back));
    }
    return {right, normalize(cross(back, right)), back};
}

/// Direction through the image-plane point (x, y) [pixels, (0,0) the top left corner of the image].
/// d = ((2x/W - 1) t W/H, (1 - 2y/H) t, -1), t = tan(fov_y / 2). Contract section 9.
inline Dir3 through_pixel(const CameraAxes& a, double fov_y, int width, int height, double x,
                          double y)
{
    const double t = std::tan(0.5 * fov_y);
    const double u = (2.0 * x / width - 1.0) * t * width / height;
    const double v = (1.0 - 2.0 * y / height) * t;
    return normalize(Vec3(a.right) * u + Vec3(a.up) * v - Vec3(a.back));
}

/// Solid angle of a pixel [sr]: of its corners on the plane at unit distance, by
/// omega(x, y) = atan(x y / sqrt(1 + x^2 + y^2)) inclusion-exclusion. Contract section 9.
inline double pixel_solid_angle(double fov_y, int width, int height, int x, int y)
{
    const double t = std::tan(0.5 * fov_y);
    const auto corner = [&](int i, int j) {
        const double u = (2.0 * i / width - 1.0) * t * width / height;
        const double v = (1.0 - 2.0 * j / height) * t;
        return std::atan(u * v / std::sqrt(1.0 + u * u + v * v));
    };
    return corner(x + 1, y) - corner(x, y) - corner(x + 1, y + 1) + corner(x, y + 1);
}

/// A = omega d^2 / cos(theta): area [m^2] that a narrow pixel cone cuts from a surface at distance
/// d.
inline double footprint_area(double solid_angle, double distance, double cos_theta)
{
    return solid_angle * distance * distance / cos_theta;
}

/// Linear radiance on a pixel grid, row 0 on top; coverage is the share of the pixel that hit
/// something.
struct Image {
    int width{}, height{};
    std::vector<Rgbf> pixels;     ///< width * height, linear Rec.709, background already mixed in
    std::vector<float> coverage;  ///< width * height, 0..1

    std::size_t at(int x, int y) const
    {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(x);
    }
};

}  // namespace relight
