#include <zlib.h>

#include <atomic>

#include "core/display/display.h"
#include "core/io/writers.h"
#include "core/shade/raytrace.h"
#include "tests/bench/raw_embree.h"
#include "tests/bench/sizes.h"
#include "tests/bench/terrain.h"
#include "tests/scenes.h"

namespace relight::bench {
namespace {

RaytraceOptions picture(int width, int height, int samples)
{
    RaytraceOptions options;
    options.width = width;
    options.height = height;
    options.samples = samples;
    return options;
}

/// The terrain fills the picture, under one light.
Scene seen_from_above()
{
    Scene scene;
    scene.lights = {test::light_of(PointLight{{0.8, -0.5, 1.2}, {}}, Rgb::grey(4.0))};
    scene.camera = {{0.6, -1.3, 1.2}, {0.0, -0.1, 0.0}, {0.0, 0.0, 1.0}};
    return scene;
}

void raytrace_image(benchmark::State& state)
{
    const Stage& stage = terrain_stage(vertices(state));
    const Scene scene = seen_from_above();
    std::uint64_t rays = 0;
    while (state.KeepRunning()) {
        Progress progress;
        rays = raytrace(stage, scene, picture(640, 480, 4), progress).rays;
    }
    rate(state, "rays", rays);
}
BENCHMARK(raytrace_image)->Name("raytrace 640x480, 4 samples a pixel")->Apply(sizes);

/// The camera's rays on a regular grid of 2 x 2 a pixel.
std::vector<RTCRay> camera_rays(const RawEmbree& raw, const Camera& camera)
{
    constexpr int width = 1280, height = 960;
    const PixelRays pixels(camera, width, height);
    std::vector<RTCRay> rays;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const Dir3 d = pixels.through(x + 0.5, y + 0.5);
            rays.push_back(rtc_ray(raw.to_box(camera.eye), d, 0.0, 16.0));
        }
    }
    return rays;
}

/// Rays traced for these camera rays: themselves, and one to the light from every hit.
std::uint64_t hit_and_look(RTCScene tree, Vec3 light, std::span<const RTCRay> rays)
{
    constexpr double off_start = 1e-4;  // of the way to the light: not the triangle itself
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    std::uint64_t shadow_rays = 0;
    for (const RTCRay& ray : rays) {
        RTCRayHit query{ray, {}};
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(tree, &context, &query);
        if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) { continue; }
        const Vec3 start{ray.org_x, ray.org_y, ray.org_z};
        const Vec3 along{ray.dir_x, ray.dir_y, ray.dir_z};
        const Vec3 p = start + along * static_cast<double>(query.ray.tfar);
        RTCRay shadow = rtc_ray(p, light - p, off_start, 1.0);
        rtcOccluded1(tree, &context, &shadow);
        ++shadow_rays;
    }
    return rays.size() + shadow_rays;
}

void raytrace_raw(benchmark::State& state)
{
    const Scene scene = seen_from_above();
    const RawEmbree& raw = terrain_embree(vertices(state));
    const Vec3 light = raw.to_box(std::get<PointLight>(scene.lights[0].shape).position);
    const std::vector<RTCRay> rays = camera_rays(raw, scene.camera);
    std::atomic<std::uint64_t> traced{0};
    while (state.KeepRunning()) {
        Progress progress;
        traced = 0;
        parallel_for(rays.size(), 4096, 0, progress, [&](std::size_t begin, std::size_t end) {
            traced += hit_and_look(raw.scene(), light, std::span(rays).subspan(begin, end - begin));
        });
    }
    rate(state, "rays", traced);
}
BENCHMARK(raytrace_raw)
    ->Name("raytrace 640x480, 4 samples a pixel beside rtcIntersect1, rtcOccluded1")
    ->Apply(sizes);

const Image& full_hd(std::size_t vertices)
{
    static std::map<std::size_t, Image> images;
    const auto [at, is_new] = images.try_emplace(vertices);
    if (is_new) {
        const Stage& stage = terrain_stage(vertices);
        Progress progress;
        at->second = raytrace(stage, seen_from_above(), picture(1920, 1080, 1), progress).image;
    }
    return at->second;
}

UnsetVector<Rgb8> displayed(const Image& image)
{
    Progress progress;
    return to_srgb8(image.pixels, {}, 0, progress);
}

void display_image(benchmark::State& state)
{
    const Image& image = full_hd(vertices(state));
    while (state.KeepRunning()) { benchmark::DoNotOptimize(displayed(image).data()); }
    rate(state, "pixels", image.pixels.size());
}
BENCHMARK(display_image)->Name("display 1920x1080: linear to sRGB")->Apply(sizes);

void write_png_image(benchmark::State& state)
{
    const Image& image = full_hd(vertices(state));
    const UnsetVector<Rgb8> pixels = displayed(image);
    while (state.KeepRunning()) {
        benchmark::DoNotOptimize(write_png(image.width, image.height, pixels).data());
    }
    rate(state, "pixels", pixels.size());
}
BENCHMARK(write_png_image)->Name("write PNG 1920x1080")->Apply(sizes);

/// The pixels' bytes less the pixel to the left (PNG's filter 1), deflated.
void deflate_image(benchmark::State& state, int level)
{
    const UnsetVector<Rgb8> pixels = displayed(full_hd(vertices(state)));
    std::vector<unsigned char> rows;
    Rgb8 left{};
    for (const Rgb8& pixel : pixels) {
        for (std::size_t c = 0; c < 3; ++c) {
            rows.push_back(static_cast<unsigned char>(pixel[c] - left[c]));
        }
        left = pixel;
    }
    std::vector<unsigned char> deflated(compressBound(rows.size()));
    while (state.KeepRunning()) {
        uLongf length = deflated.size();
        compress2(deflated.data(), &length, rows.data(), rows.size(), level);
        benchmark::DoNotOptimize(length);
    }
    rate(state, "pixels", pixels.size());
}
BENCHMARK_CAPTURE(deflate_image, fast, 1)
    ->Name("write PNG 1920x1080 beside zlib level 1, 1 thread")
    ->Apply(sizes);
BENCHMARK_CAPTURE(deflate_image, small, 5)
    ->Name("write PNG 1920x1080 beside zlib level 5, 1 thread")
    ->Apply(sizes);

}  // namespace
}  // namespace relight::bench
