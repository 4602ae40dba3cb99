#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/camera.h"
#include "core/base/sobol.h"
#include "core/shade/raytrace.h"
#include "core/shade/world.h"

namespace relight {

/// A picture in the making: all that its blocks share.
struct Canvas {
    const World& world;
    const RaytraceOptions& options;
    PixelRays pixel_rays;
    int side;  // of the grid of samples
    Rendered& rendered;

    std::size_t lights() const { return world.scene.lights.size(); }
    std::size_t columns() const { return lights() + 1; }  // of sums: the last is no light's doing
    std::size_t replicates() const { return static_cast<std::size_t>(side); }
    std::size_t samples() const { return replicates() * replicates(); }
};

/// A square of the picture, cut off at its edges: what its rays meet lies together in memory.
struct Tile {
    std::size_t x = 0, y = 0, width = 0, height = 0;

    std::size_t pixels() const { return width * height; }
};

/// How a picture is cut up: in squares of `side` pixels, row by row.
struct Tiling {
    std::size_t width, height, side;

    std::size_t across() const { return (width + side - 1) / side; }
    std::size_t count() const { return across() * ((height + side - 1) / side); }
    Tile tile(std::size_t number) const
    {
        const std::size_t x = number % across() * side, y = number / across() * side;
        return {x, y, std::min(side, width - x), std::min(side, height - y)};
    }
};

/// One sample of a pixel on its way.
struct CameraSample {
    Rgb* sums;          // of its pixel and replicate, canvas.columns()
    std::size_t pixel;  // of its tile
    Sequence sequence;
    std::uint32_t point;
};

/// The pixels of a tile and their samples.
struct Block {
    Tile tile;
    std::vector<Rgb> sums;  // pixel x replicate x columns
    std::vector<std::size_t> hits;
    std::vector<Vec3> normals;
    std::vector<CameraSample> samples;
    std::vector<ShadowRay> rays;  // one a sample
};

/// The tile's samples and their rays.
Block aim(const Canvas& canvas, const Tile& tile);

/// Puts what the sums have become into the picture.
void settle(const Canvas& canvas, const Block& block);

}  // namespace relight
