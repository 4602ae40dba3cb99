#include "core/geometry/cloud_normals.h"

namespace relight {

std::vector<Dir3> estimate_normals(std::span<const Point3> points,
                                   std::span<const std::uint32_t> /*absent*/,
                                   const std::optional<Point3>& /*toward*/, unsigned /*threads*/,
                                   Progress& /*progress*/)
{
    return std::vector<Dir3>(points.size());
}

}  // namespace relight
