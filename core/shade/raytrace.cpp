#include "core/shade/raytrace.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include "core/shade/paths.h"
#include "core/shade/pixel_samples.h"

namespace relight {
namespace {

// Paths times lights (and eight for the rest of a path's work) that are followed together.
constexpr std::size_t most_work = 8192;

/// through_pixel() of one camera and picture: what all pixels share is computed once.
class PixelRays {
  public:
    PixelRays(const Camera& camera, int width, int height)
    {
        const CameraAxes a = axes(camera);
        const double t = std::tan(0.5 * camera.fov_y);
        across_ = Vec3(a.right) * (2.0 * t / height);
        down_ = Vec3(a.up) * (-2.0 * t / height);
        corner_ = Vec3(a.up) * t - Vec3(a.right) * (t * width / height) - Vec3(a.back);
    }
    Dir3 through(double x, double y) const { return normalize(corner_ + across_ * x + down_ * y); }

  private:
    Vec3 across_, down_;  // a pixel, on the plane at unit distance
    Vec3 corner_;         // the top left
};

/// A picture in the making: all that its blocks share.
struct Canvas {
    const World& world;
    const RaytraceOptions& options;
    PixelRays pixel_rays;
    std::vector<LightView> lamps;  // of the world, from the eye
    int side;                      // of the grid of samples
    Rendered& rendered;

    std::size_t lights() const { return world.scene.lights.size(); }
    std::size_t columns() const { return lights() + 1; }  // of sums: the last is no light's doing
    std::size_t replicates() const { return static_cast<std::size_t>(side); }
    std::size_t samples() const { return replicates() * replicates(); }
};

/// One sample of a pixel on its way.
struct CameraSample {
    Rgb* sums;          // of its pixel and replicate, canvas.columns()
    std::size_t pixel;  // of its tile
    Sequence sequence;
    std::uint32_t point;
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

/// The pixels of a tile and their samples.
struct Block {
    Tile tile;
    std::vector<Rgb> sums;  // pixel x replicate x columns
    std::vector<std::size_t> hits;
    std::vector<Vec3> normals;
    std::vector<CameraSample> samples;
    std::vector<ShadowRay> rays;  // one a sample
};

Block aim(const Canvas& canvas, const Tile& tile)
{
    const RaytraceOptions& options = canvas.options;
    const Point3 eye = canvas.world.scene.camera.eye;
    Block block{tile, {}, {}, {}, {}, {}};
    block.sums.resize(tile.pixels() * canvas.replicates() * canvas.columns());
    block.hits.resize(tile.pixels());
    block.normals.resize(tile.pixels());
    block.samples.reserve(tile.pixels() * canvas.samples());
    block.rays.reserve(tile.pixels() * canvas.samples());
    PixelSamples places(canvas.side, options.seed);
    for (std::size_t i = 0; i < tile.pixels(); ++i) {
        const std::size_t x = tile.x + i % tile.width, y = tile.y + i / tile.width;
        const std::size_t pixel = y * static_cast<std::size_t>(options.width) + x;
        places.move_to(pixel);
        const auto column = static_cast<double>(x), row = static_cast<double>(y);
        const Sequence sequence(options.seed, pixel, 0, 0);
        for (int s = 0; s < static_cast<int>(canvas.samples()); ++s) {
            const auto [dx, dy] = places.at(s);
            const auto replicate = static_cast<std::size_t>(places.replicate(s));
            const std::size_t first = (i * canvas.replicates() + replicate) * canvas.columns();
            block.samples.push_back({block.sums.data() + first, i,
                                     sequence.replicate(static_cast<std::uint32_t>(replicate)),
                                     static_cast<std::uint32_t>(places.row(s))});
            block.rays.push_back({eye, canvas.pixel_rays.through(column + dx, row + dy), 0.0,
                                  std::numeric_limits<double>::infinity()});
        }
    }
    return block;
}

/// What a camera ray sees of the lights themselves: those that stand before what it hit, and where
/// it hit nothing the sky.
void see_lights(const Canvas& canvas, const ShadowRay& ray, const Hit& hit, Rgb* sums)
{
    const World& world = canvas.world;
    const bool missed = hit.primitive == ~0U;
    const double margin = world.stage.bvh->clearance(0.0).offset;  // a light on a wall is before it
    for (std::size_t l = 0; l < world.lamps.size(); ++l) {
        const Lamp& lamp = world.lamps[l];
        const bool is_hidden = !missed && std::isinf(lamp.radius);  // a sky
        if (lamp.delta || is_hidden || !may_be_seen(lamp, ray.origin, ray.direction)) { continue; }
        const LightSample there = look(canvas.lamps[l], ray.direction);
        if (!there.wi) { continue; }
        const bool seen = std::isfinite(there.distance)
                              ? missed || there.distance <= hit.distance + margin
                              : missed && !canvas.options.background;
        if (seen) { sums[lamp.number] += there.L * lamp.light->power; }
    }
    if (missed && canvas.options.background) {
        sums[canvas.lights()] += *canvas.options.background;
    }
}

/// Camera rays, and the paths that start where they hit.
void trace_block(const Canvas& canvas, Block& block, RayQueue& queue)
{
    const World& world = canvas.world;
    std::vector<Hit> hits(block.rays.size());
    world.stage.bvh->nearest(block.rays, hits);
    queue.count(block.rays.size());
    std::vector<EyePath> paths;
    paths.reserve(hits.size());
    for (std::size_t i = 0; i < hits.size(); ++i) {
        const ShadowRay& ray = block.rays[i];
        const CameraSample& sample = block.samples[i];
        see_lights(canvas, ray, hits[i], sample.sums);
        if (hits[i].primitive == ~0U) { continue; }
        ++block.hits[sample.pixel];
        auto seen = see(world.stage, world.scene, ray.origin, ray.direction, hits[i]);
        if (!seen) { continue; }
        block.normals[sample.pixel] += seen->at.frame.n;
        if (seen->front) { sample.sums[canvas.lights()] += emission(*seen->material, seen->wo.z); }
        paths.push_back(
            {std::move(*seen), Rgb::grey(1.0), sample.sums, sample.sequence, sample.point});
    }
    follow(world, std::move(paths), queue);
}

/// Standard error of the mean of samples that came in replicates of these sums.
Rgb standard_error(const std::vector<Rgb>& sums, double samples)
{
    const auto n = static_cast<double>(sums.size());
    Rgb sum, squares;
    for (const Rgb& one : sums) {  // from the first one: no rounding where all are the same
        const Rgb d = one - sums.front();
        sum += d;
        squares += d * d;
    }
    const double factor = student_factor(static_cast<unsigned>(sums.size()));
    const auto root = [&](double total, double total_squares) {
        const double variance = std::max(0.0, total_squares - total * total / n) / (n - 1.0);
        return factor * std::sqrt(n * variance) / samples;
    };
    return {root(sum.r, squares.r), root(sum.g, squares.g), root(sum.b, squares.b)};
}

void settle(const Canvas& canvas, const Block& block)
{
    Rendered& to = canvas.rendered;
    const auto samples = static_cast<double>(canvas.samples());
    std::vector<Rgb> replicates(canvas.replicates());
    const Tile& tile = block.tile;
    for (std::size_t i = 0; i < tile.pixels(); ++i) {
        const std::size_t pixel =
            (tile.y + i / tile.width) * static_cast<std::size_t>(to.image.width) + tile.x +
            i % tile.width;
        const Rgb* sums = block.sums.data() + i * canvas.replicates() * canvas.columns();
        const auto at = [&](std::size_t r, std::size_t column) {
            return sums[r * canvas.columns() + column];
        };
        Rgb total;
        for (std::size_t r = 0; r < canvas.replicates(); ++r) {
            replicates[r] = {};
            for (std::size_t c = 0; c < canvas.columns(); ++c) { replicates[r] += at(r, c); }
            total += replicates[r];
        }
        const auto hits = static_cast<double>(block.hits[i]);
        to.image.pixels[pixel] = to_float(total / samples);
        to.image.coverage[pixel] = static_cast<float>(hits / samples);
        if (!to.standard_error.empty()) {
            to.standard_error[pixel] = to_float(standard_error(replicates, samples));
        }
        for (std::size_t l = 0; l < to.per_light.size(); ++l) {
            Rgb one;
            for (std::size_t r = 0; r < canvas.replicates(); ++r) { one += at(r, l); }
            to.per_light[l][pixel] = to_float(one / samples);
        }
        if (!to.normal.empty()) {
            const Vec3 n = block.normals[i] / std::max(1.0, hits);
            to.normal[pixel] = to_float({n.x, n.y, n.z});
        }
    }
}

}  // namespace

Rendered raytrace(const Stage& stage, const Scene& scene, const RaytraceOptions& options,
                  Progress& progress)
{
    const std::size_t pixels =
        static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height);
    const World world = world_of(stage, scene);
    Rendered rendered;
    std::vector<LightView> lamps;
    for (const Lamp& lamp : world.lamps) {
        lamps.push_back(view(lamp.light->shape, scene.camera.eye));
    }
    const Canvas canvas{world,
                        options,
                        PixelRays(scene.camera, options.width, options.height),
                        std::move(lamps),
                        static_cast<int>(std::ceil(std::sqrt(options.samples))),
                        rendered};
    rendered.image.width = options.width;
    rendered.image.height = options.height;
    rendered.image.pixels.resize(pixels);
    rendered.image.coverage.resize(pixels);
    if (canvas.replicates() > 1) { rendered.standard_error.resize(pixels); }
    if (options.per_light) {
        rendered.per_light.assign(scene.lights.size(), std::vector<Rgbf>(pixels));
    }
    if (options.normal) { rendered.normal.resize(pixels); }
    const std::size_t work = canvas.samples() * (canvas.lights() + 8);
    std::atomic<std::uint64_t> rays{0};
    const std::size_t together = std::max<std::size_t>(1, most_work / work);  // pixels
    const Tiling tiling{static_cast<std::size_t>(options.width),
                        static_cast<std::size_t>(options.height),
                        static_cast<std::size_t>(std::sqrt(static_cast<double>(together)))};
    progress.expect(pixels);
    parallel_for(tiling.count(), 1, options.threads, progress,
                 [&](std::size_t number, std::size_t /*end*/) {
                     Block block = aim(canvas, tiling.tile(number));
                     RayQueue queue(*stage.bvh);
                     trace_block(canvas, block, queue);
                     settle(canvas, block);
                     rays += queue.traced();
                     progress.advance(block.tile.pixels());
                 });
    rendered.rays = rays;
    return rendered;
}

}  // namespace relight
