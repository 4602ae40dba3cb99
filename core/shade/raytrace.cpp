#include "core/shade/raytrace.h"

#include <atomic>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "core/shade/canvas.h"
#include "core/shade/paths.h"

namespace relight {
namespace {

// Paths times lights (and eight for the rest of a path's work) that are followed together.
constexpr std::size_t most_work = 8192;

/// A sky of many directions, where nothing is hit.
void see_sky(const Lamp& lamp, const Block& block, std::span<const Hit> hits)
{
    std::vector<std::size_t> missed;
    missed.reserve(hits.size());
    for (std::size_t i = 0; i < hits.size(); ++i) {
        if (hits[i].primitive == ~0U) { missed.push_back(i); }
    }
    look_along(
        *lamp.dome, missed.size(), [&](std::size_t m) { return block.rays[missed[m]].direction; },
        [&](std::size_t m, const LightSample& there) {
            block.samples[missed[m]].sums[lamp.number] += there.L * lamp.light->power;
        });
}

/// Any other light, where it stands before what is hit; a sun or a sky where nothing is.
void see_lamp(const Canvas& canvas, const Lamp& lamp, const Block& block, std::span<const Hit> hits)
{
    const World& world = canvas.world;
    const LightView there_from_eye = view(lamp.light->shape, world.scene.camera.eye);
    const double margin = world.stage.bvh->clearance(0.0).offset;  // a light on a wall is before it
    for (std::size_t i = 0; i < hits.size(); ++i) {
        const ShadowRay& ray = block.rays[i];
        const bool missed = hits[i].primitive == ~0U;
        if ((std::isinf(lamp.radius) && !missed) || !may_be_seen(lamp, ray.origin, ray.direction)) {
            continue;
        }
        const LightSample there = look(there_from_eye, ray.direction);
        if (!there.wi) { continue; }
        const bool seen = std::isfinite(there.distance)
                              ? missed || there.distance <= hits[i].distance + margin
                              : missed && !canvas.options.background;
        if (seen) { block.samples[i].sums[lamp.number] += there.L * lamp.light->power; }
    }
}

/// What the camera's rays see of the lights themselves.
void see_lights(const Canvas& canvas, const Block& block, std::span<const Hit> hits)
{
    for (const Lamp& lamp : canvas.world.lamps) {
        if (lamp.delta) { continue; }
        if (!lamp.dome) {
            see_lamp(canvas, lamp, block, hits);
        } else if (!canvas.options.background) {
            see_sky(lamp, block, hits);
        }
    }
}

/// Camera rays, and the paths that start where they hit.
void trace_block(const Canvas& canvas, Block& block, RayQueue& queue)
{
    const World& world = canvas.world;
    std::vector<Hit> hits(block.rays.size());
    world.stage.bvh->nearest(block.rays, hits);
    queue.count(block.rays.size());
    see_lights(canvas, block, hits);
    std::vector<EyePath> paths;
    paths.reserve(hits.size());
    for (std::size_t i = 0; i < hits.size(); ++i) {
        const ShadowRay& ray = block.rays[i];
        const CameraSample& sample = block.samples[i];
        Rgb& no_light = sample.sums[canvas.lights()];
        if (hits[i].primitive == ~0U) {
            no_light += canvas.options.background.value_or(Rgb{});
            continue;
        }
        ++block.hits[sample.pixel];
        EyePath path{see(world.stage, world.scene, ray.origin, ray.direction, hits[i]),
                     Rgb::grey(1.0), sample.sums, sample.sequence, sample.point};
        const Seen& seen = path.seen;
        if (!seen.is_there()) { continue; }
        block.normals[sample.pixel] += seen.at.frame.n;
        if (seen.front) { no_light += emission(*seen.material, seen.wo.z); }
        paths.push_back(std::move(path));
    }
    follow(world, std::move(paths), queue);
}

}  // namespace

Rendered raytrace(const Stage& stage, const Scene& scene, const RaytraceOptions& options,
                  Progress& progress)
{
    const std::size_t pixels =
        static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height);
    const World world = world_of(stage, scene);
    Rendered rendered;
    const Canvas canvas{world, options, PixelRays(scene.camera, options.width, options.height),
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
