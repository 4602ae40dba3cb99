#include "core/shade/raytrace.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "core/shade/paths.h"
#include "core/shade/pixel_samples.h"

namespace relight {
namespace {

// Paths times lights (and eight for the rest of a path's work) that are followed together.
constexpr std::size_t most_work = 8192;

/// A picture in the making: all that its blocks share.
struct Canvas {
    const World& world;
    const RaytraceOptions& options;
    CameraAxes camera;
    int side;  // of the grid of samples
    Rendered& rendered;

    std::size_t lights() const { return world.scene.lights.size(); }
    std::size_t columns() const { return lights() + 1; }  // of sums: the last is no light's doing
    std::size_t replicates() const { return static_cast<std::size_t>(side); }
    std::size_t samples() const { return replicates() * replicates(); }
};

/// One sample of a pixel on its way.
struct CameraSample {
    Rgb* sums;  // of its pixel and replicate, canvas.columns()
    std::size_t pixel;
    Sequence sequence;
    std::uint32_t point;
};

/// Consecutive pixels and their samples.
struct Block {
    std::size_t begin = 0, end = 0;
    std::vector<Rgb> sums;  // pixel x replicate x columns
    std::vector<std::size_t> hits;
    std::vector<Vec3> normals;
    std::vector<CameraSample> samples;
    std::vector<ShadowRay> rays;  // one a sample
};

Block aim(const Canvas& canvas, std::size_t begin, std::size_t end)
{
    const RaytraceOptions& options = canvas.options;
    const Camera& camera = canvas.world.scene.camera;
    const auto width = static_cast<std::size_t>(options.width);
    Block block{begin, end, {}, {}, {}, {}, {}};
    block.sums.resize((end - begin) * canvas.replicates() * canvas.columns());
    block.hits.resize(end - begin);
    block.normals.resize(end - begin);
    block.samples.reserve((end - begin) * canvas.samples());
    block.rays.reserve((end - begin) * canvas.samples());
    PixelSamples places(canvas.side, options.seed);
    for (std::size_t pixel = begin; pixel < end; ++pixel) {
        places.move_to(pixel);
        const std::size_t column = pixel % width;
        const std::size_t row = pixel / width;
        for (int s = 0; s < static_cast<int>(canvas.samples()); ++s) {
            const auto [dx, dy] = places.at(s);
            const auto replicate = static_cast<std::size_t>(places.replicate(s));
            const Dir3 direction =
                through_pixel(canvas.camera, camera.fov_y, options.width, options.height,
                              static_cast<double>(column) + dx, static_cast<double>(row) + dy);
            const std::size_t first =
                ((pixel - begin) * canvas.replicates() + replicate) * canvas.columns();
            block.samples.push_back(
                {block.sums.data() + first, pixel,
                 Sequence(options.seed, pixel, 0, static_cast<std::uint32_t>(replicate)),
                 static_cast<std::uint32_t>(places.row(s))});
            block.rays.push_back(
                {camera.eye, direction, 0.0, std::numeric_limits<double>::infinity()});
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
    for (const Lamp& lamp : world.lamps) {
        if (lamp.delta) { continue; }
        const LightSample there = look(lamp.light->shape, ray.origin, ray.direction);
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
        ++block.hits[sample.pixel - block.begin];
        const auto seen = see(world.stage, world.scene, ray.origin, ray.direction, hits[i]);
        if (!seen) { continue; }
        block.normals[sample.pixel - block.begin] += seen->at.frame.n;
        if (seen->front) { sample.sums[canvas.lights()] += emission(*seen->material, seen->wo.z); }
        paths.push_back({*seen, Rgb::grey(1.0), sample.sums, sample.sequence, sample.point});
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
    for (std::size_t pixel = block.begin; pixel < block.end; ++pixel) {
        const std::size_t i = pixel - block.begin;
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
    const Canvas canvas{world, options, axes(scene.camera),
                        static_cast<int>(std::ceil(std::sqrt(options.samples))), rendered};
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
    progress.expect(pixels);
    parallel_for(pixels, std::max<std::size_t>(1, most_work / work), options.threads, progress,
                 [&](std::size_t begin, std::size_t end) {
                     Block block = aim(canvas, begin, end);
                     RayQueue queue(*stage.bvh);
                     trace_block(canvas, block, queue);
                     settle(canvas, block);
                     rays += queue.traced();
                     progress.advance(end - begin);
                 });
    rendered.rays = rays;
    return rendered;
}

}  // namespace relight
