#pragma once

#include <optional>
#include <vector>

#include "core/scene.h"
#include "core/trace/stage.h"

namespace relight {

struct RaytraceOptions {
    int width = 800, height = 600;
    int samples = 16;  ///< a pixel; rounded up to a square: one in each cell of a grid
    /// Linear radiance where nothing is hit; nothing: the skies among the lights, their sun's disc
    /// included, else black.
    std::optional<Rgb> background;
    std::uint64_t seed = 0;
    unsigned threads = 0;
    bool per_light = false;
    bool normal = false;
};

/// Arrays of width * height, in the image's order.
struct Rendered {
    Image image;
    /// Of each pixel's mean, a band: +-1.96 of it is a 95 % band. The n^2 samples of a pixel form n
    /// replicates with random numbers of their own (pixel_samples.h); their means' spread is the
    /// error, with Student's factor for so few. Honest, from 16 samples on, for the noise of lights
    /// and bounces and for what changes steadily across a pixel; at sharp edges up to some three
    /// times too large, for all samples together know an edge better than a replicate does. 0 where
    /// all agree. Empty with one sample a pixel: nothing tells it then.
    std::vector<Rgbf> standard_error;
    /// One image a light of the scene (black if it is not enabled): what of `image` is its doing,
    /// seen straight, as sky or reflected; if asked for. They add up to the image but for what no
    /// light brings: a given background, and the emission of the surfaces that the camera sees.
    std::vector<std::vector<Rgbf>> per_light;
    /// Mean shading normal, world space, of the samples that hit something, on the side that they
    /// saw (not unit where it changes in the pixel; zero where nothing is); if asked for.
    std::vector<Rgbf> normal;
    std::uint64_t rays = 0;  ///< camera, shadow and bounce rays traced
};

/// The scene from its camera: radiance averaged over each pixel's footprint (box filter), shading
/// from interpolated normals at every sample, on the side that the camera sees. One path a sample
/// (paths.h) brings direct light with its shadows, glossy reflections of lights and skies, and
/// light by way of transport.bounces other surfaces, materials in full. Rect, disk and sphere
/// lights are seen where they stand before the surface; they let through what is behind them. The
/// same bytes for any number of threads.
Rendered raytrace(const Stage& stage, const Scene& scene, const RaytraceOptions& options,
                  Progress& progress);

/// A camera that frames the surface: from the front, a little to the right and above (glTF's +Y
/// up).
Camera frame(const Bounds& bounds, double fov_y, double aspect);

}  // namespace relight
