#include <algorithm>

#include "core/shade/raytrace.h"

namespace relight {

Camera frame(const Bounds& bounds, double fov_y, double aspect)
{
    constexpr double margin = 1.06;  // a little air around the model
    const Point3 centre = bounds.centre();
    Camera camera{centre + Vec3{0.45, 0.3, 1.0}, centre, {0, 1, 0}, fov_y};
    const CameraAxes a = axes(camera);
    const double t = std::tan(0.5 * fov_y);
    double distance = 0.0;
    for (int corner = 0; corner < 8; ++corner) {
        const Point3 p{(corner & 1) != 0 ? bounds.max.x : bounds.min.x,
                       (corner & 2) != 0 ? bounds.max.y : bounds.min.y,
                       (corner & 4) != 0 ? bounds.max.z : bounds.min.z};
        const Vec3 from_centre = p - centre;
        const double across = std::abs(dot(from_centre, a.right)) / (t * aspect);
        const double up = std::abs(dot(from_centre, a.up)) / t;
        distance = std::max(distance, dot(from_centre, a.back) + margin * std::max(across, up));
    }
    if (!(distance > 0.0)) { distance = 1.0; }  // all in one point
    camera.eye = centre + Vec3(a.back) * distance;
    return camera;
}

}  // namespace relight
