#pragma once

#include <span>

#include "core/base/camera.h"
#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/geometry/mesh.h"
#include "core/geometry/surface.h"

namespace relight {

struct PreviewOptions {
    int width = 800, height = 600;
    int samples = 8;    ///< a pixel, in a square grid: 1, 4, 9 or 16
    Rgb8 background{};  ///< display-referred
};

/// 8-bit RGB picture, row 0 on top.
struct Picture {
    int width{}, height{};
    std::vector<Rgb8> pixels;          ///< the background mixed in, by the share that alpha leaves
    std::vector<unsigned char> alpha;  ///< share of the pixel that the surface covers; 255: all
};

/// VTK's picture of the surface with these display-referred vertex colours as they are (no lighting
/// of VTK's), on a surfaceless EGL context: no display needed. Calls are served one after the other
/// by one long-lived render thread. A cloud's points are discs along its surface, 1.5 times the
/// local spacing in radius; of more than 200,000 so many are drawn, larger for it.
/// Errors: Internal if there is no EGL driver, Cancelled.
Result<Picture> preview(const Mesh& mesh, const Surface& surface, std::span<const Rgb8> colors,
                        const Camera& camera, const PreviewOptions& options, Progress& progress);

}  // namespace relight
