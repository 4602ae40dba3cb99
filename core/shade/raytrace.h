#pragma once

#include "core/scene.h"
#include "core/trace/stage.h"

namespace relight {

struct RaytraceOptions {
    int width = 800, height = 600;
    int samples = 16;  ///< a pixel; rounded up to a square: one in each cell of a grid
    Rgb background;    ///< linear radiance where nothing is hit
    std::uint64_t seed = 0;
    unsigned threads = 0;
};

struct Rendered {
    Image image;
    std::uint64_t rays = 0;  ///< camera and shadow rays traced
};

/// The scene from its camera: radiance averaged over each pixel's footprint (box filter), shading
/// from interpolated normals at every sample, shadows traced. The same bytes for any number of
/// threads.
Rendered raytrace(const Stage& stage, const Scene& scene, const RaytraceOptions& options,
                  Progress& progress);

/// A camera that frames the surface: from the front, a little to the right and above (glTF's +Y
/// up).
Camera frame(const Bounds& bounds, double fov_y, double aspect);

}  // namespace relight
