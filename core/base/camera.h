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

/// Where a picture's pixels lie on the plane at unit distance before the camera: x to the right, y
/// up, both 0 in the middle; columns and rows are counted from the top left corner [pixels].
/// x = (2 column/W - 1) t W/H, y = (1 - 2 row/H) t, t = tan(fov_y / 2). Contract section 9.
struct ImagePlane {
    double left, top;  ///< of the picture
    double pixel;      ///< width and height of one

    ImagePlane(double fov_y, int width, int height)
    {
        const double t = std::tan(0.5 * fov_y);
        left = -(t * width / height);
        top = t;
        pixel = 2.0 * t / height;
    }
    double x(double column) const { return left + pixel * column; }
    double y(double row) const { return top - pixel * row; }
};

/// Directions through a picture's places: what all share is computed once.
class PixelRays {
  public:
    PixelRays(const Camera& camera, int width, int height)
    {
        const CameraAxes a = axes(camera);
        const ImagePlane plane(camera.fov_y, width, height);
        across_ = Vec3(a.right) * plane.pixel;
        down_ = Vec3(a.up) * -plane.pixel;
        corner_ = Vec3(a.up) * plane.top + Vec3(a.right) * plane.left - Vec3(a.back);
    }
    /// (0, 0): the top left corner; a pixel's middle is half a pixel on.
    Dir3 through(double column, double row) const
    {
        return normalize(corner_ + across_ * column + down_ * row);
    }

  private:
    Vec3 across_, down_;  // a pixel
    Vec3 corner_;         // the top left
};

/// Solid angle of a pixel [sr]: of its corners on the plane at unit distance, by
/// omega(x, y) = atan(x y / sqrt(1 + x^2 + y^2)) inclusion-exclusion. Contract section 9.
inline double pixel_solid_angle(double fov_y, int width, int height, int x, int y)
{
    const ImagePlane plane(fov_y, width, height);
    const auto corner = [&](int i, int j) {
        const double u = plane.x(i), v = plane.y(j);
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
