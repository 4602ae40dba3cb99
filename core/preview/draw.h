#pragma once

#include <vector>

#include "core/base/camera.h"
#include "core/base/result.h"
#include "core/preview/preview.h"

namespace relight {

/// What OpenGL is given: everything recentred and scaled to about one unit, so that single
/// precision says where things are whatever their size and place.
struct Drawing {
    std::vector<float> positions{};    ///< xyz of each vertex
    std::vector<Rgb8> colors{};        ///< of each vertex, drawn as they are
    std::vector<long long> corners{};  ///< three vertices a triangle
    Point3 eye;
    CameraAxes axes;
    double fov_y{};                ///< [rad]
    double near = 0.5, far = 1.0;  ///< depths between which everything lies
    PreviewOptions options;
};

/// Draws on the calling thread, which must be the same each time: it binds the OpenGL context. Asks
/// `progress.stopped()` once a tile. (The drawing is not const: VTK wants pointers it could write
/// to.)
Result<Picture> draw(Drawing& drawing, const Progress& progress);

}  // namespace relight
