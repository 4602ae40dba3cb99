#include "core/shade/raytrace.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "core/shade/pixel_samples.h"
#include "core/transport/shadow.h"

namespace relight {
namespace {

constexpr std::size_t rows = 4;  // of the image, between two looks at progress

/// A point seen by the camera, ready to be lit.
struct Seen {
    Point3 position;
    Dir3 wo;        // to the viewer
    Dir3 ng;        // geometric normal, on the side of the shading normal
    Dir3 n;         // shading normal
    Point3 lifted;  // where shadow rays start before they step off the surface
    double spacing{};
    Rgb vertex_color = Rgb::grey(1.0);
    bool lit = false;  // it has a side to be lit
};

/// The tangent planes of the corners, interpolated: p + sum b_i max(0, (p_i - p) . n_i) n_i. Where
/// a coarse mesh stands for a round one, shadow rays start from the round one. Contract section 7;
/// Hanika 2021 ("Hacking the shadow terminator").
Point3 onto_tangent_planes(Point3 p, const std::array<Point3, 3>& corner,
                           const std::array<Dir3, 3>& normal, const std::array<double, 3>& b)
{
    Vec3 lift;
    for (std::size_t i = 0; i < 3; ++i) {
        const double below = std::min(0.0, dot(p - corner[i], normal[i]));
        lift += Vec3(normal[i]) * (-below * b[i]);
    }
    return p + lift;
}

void see_point(const Stage& stage, const Hit& hit, Seen& seen)
{
    seen.n = stage.surface->normals[hit.primitive];
    seen.ng = seen.n;
    seen.lifted = seen.position;
    seen.spacing = static_cast<double>(stage.surface->spacing[hit.primitive]);
    if (!stage.mesh->colors.empty()) {
        seen.vertex_color = to_double(stage.mesh->colors[hit.primitive]);
    }
}

void see_triangle(const Stage& stage, const Hit& hit, Terminator terminator, Seen& seen)
{
    const Triangle& t = stage.surface->triangles[hit.primitive];
    const std::array<double, 3> b{1.0 - hit.u - hit.v, hit.u, hit.v};
    std::array<Point3, 3> corner;
    std::array<Dir3, 3> normal;
    Vec3 n;
    Rgb color;
    seen.spacing = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < 3; ++i) {
        corner[i] = stage.mesh->positions[t[i]];
        normal[i] = stage.surface->normals[t[i]];
        n += Vec3(normal[i]) * b[i];
        if (!stage.mesh->colors.empty()) { color += to_double(stage.mesh->colors[t[i]]) * b[i]; }
        seen.spacing = std::min(seen.spacing, static_cast<double>(stage.surface->spacing[t[i]]));
    }
    if (!stage.mesh->colors.empty()) { seen.vertex_color = color; }
    seen.position = corner[0] + (corner[1] - corner[0]) * b[1] + (corner[2] - corner[0]) * b[2];
    seen.ng = normalize(cross(corner[1] - corner[0], corner[2] - corner[0]));
    seen.n = normalize(n);
    if (!seen.n) { seen.n = seen.ng; }
    if (dot(seen.ng, seen.n) < 0.0) {
        seen.ng = -seen.ng;
    }  // filed normals say which side is the front
    seen.lifted = terminator == Terminator::Smooth
                      ? onto_tangent_planes(seen.position, corner, normal, b)
                      : seen.position;
}

Seen see(const Stage& stage, const Scene& scene, Point3 eye, Dir3 direction, const Hit& hit)
{
    Seen seen;
    seen.wo = -direction;
    seen.position = eye + Vec3(direction) * hit.distance;
    if (hit.is_point) {
        see_point(stage, hit, seen);
    } else {
        see_triangle(stage, hit, scene.transport.terminator, seen);
    }
    if (dot(seen.ng, seen.wo) < 0.0) {  // the camera sees the back: that side is lit and shown
        seen.ng = -seen.ng;
        seen.n = -seen.n;
        seen.lifted = seen.position;
    }
    seen.lit = static_cast<bool>(seen.ng);
    // An interpolated normal may lean away from a viewer who does see the surface: lean it back.
    constexpr double least_cosine = 1e-3;
    const double cos_o = dot(seen.n, seen.wo);
    if (seen.lit && cos_o < least_cosine) {
        seen.n = normalize(Vec3(seen.n) + Vec3(seen.wo) * (least_cosine - cos_o));
    }
    return seen;
}

/// The light of one pixel's samples: each term counts unless its shadow ray is blocked.
struct PixelWork {
    std::vector<ShadowRay> rays;
    std::vector<Rgb> radiance;  // one a ray
    std::vector<std::uint8_t> blocked;
    Rgb unshadowed;  // from lights that need no ray
};

void light_sample(const Stage& stage, const Scene& scene, const Seen& seen, PixelWork& work)
{
    const Frame frame = frame_around(seen.n);
    const Vec3 wo = frame.to_local(seen.wo);
    const Clearance clear = stage.bvh->clearance(seen.spacing);
    for (const Light& light : scene.lights) {
        if (!light.enabled) { continue; }
        const Arrival arrival = arrive(light.shape, seen.position);
        const double cos_i = dot(seen.n, arrival.wi);
        if (!(cos_i > 0.0) || !(arrival.per_unit > 0.0)) { continue; }
        const Irradiance E{light.power * (cos_i * per_unit_m2(arrival, scene.length_unit_m))};
        const Radiance L = f(scene.material, frame.to_local(arrival.wi), wo, seen.vertex_color) * E;
        if (!scene.transport.shadows || !light.cast_shadows) {
            work.unshadowed += L.value;
            continue;
        }
        const Point3 origin = seen.lifted + Vec3(seen.ng) * clear.offset;
        work.rays.push_back(
            shadow_ray(*stage.bvh, seen.position, origin, clear.from, arrival, scene.transport));
        work.radiance.push_back(L.value);
    }
}

/// Sum of what the shadow rays let through.
Rgb collect(const Stage& stage, PixelWork& work)
{
    work.blocked.assign(work.rays.size(), 0);
    stage.bvh->occluded(work.rays, work.blocked);
    Rgb sum = work.unshadowed;
    for (std::size_t r = 0; r < work.rays.size(); ++r) {
        if (work.blocked[r] == 0) { sum += work.radiance[r]; }
    }
    return sum;
}

}  // namespace

Rendered raytrace(const Stage& stage, const Scene& scene, const RaytraceOptions& options,
                  Progress& progress)
{
    const int side = static_cast<int>(std::ceil(std::sqrt(options.samples)));
    const int samples = side * side;
    const CameraAxes camera = axes(scene.camera);
    Rendered rendered;
    Image& image = rendered.image;
    image.width = options.width;
    image.height = options.height;
    const std::size_t pixels =
        static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height);
    image.pixels.resize(pixels);
    image.coverage.resize(pixels);
    std::atomic<std::uint64_t> rays{0};
    progress.expect(pixels);

    const auto render_pixel = [&](int x, int y, PixelSamples& places, PixelWork& work) {
        const std::size_t at = image.at(x, y);
        places.move_to(at);
        work.rays.clear();
        work.radiance.clear();
        work.unshadowed = {};
        int hits = 0;
        for (int s = 0; s < samples; ++s) {
            const auto [dx, dy] = places.at(s);
            const Dir3 direction = through_pixel(camera, scene.camera.fov_y, options.width,
                                                 options.height, x + dx, y + dy);
            const Hit hit = stage.bvh->nearest(scene.camera.eye, direction);
            if (hit.primitive == ~0U) { continue; }
            ++hits;
            const Seen seen = see(stage, scene, scene.camera.eye, direction, hit);
            if (seen.lit) { light_sample(stage, scene, seen, work); }
        }
        rays += static_cast<std::uint64_t>(samples) + work.rays.size();
        const double covered = static_cast<double>(hits) / samples;
        const Rgb L = collect(stage, work) / samples + options.background * (1.0 - covered);
        image.pixels[at] = to_float(L);
        image.coverage[at] = static_cast<float>(covered);
    };
    parallel_for(static_cast<std::size_t>(options.height), rows, options.threads, progress,
                 [&](std::size_t begin, std::size_t end) {
                     PixelWork work;
                     PixelSamples places(side, options.seed);
                     for (std::size_t y = begin; y < end; ++y) {
                         if (progress.stopped()) { return; }
                         for (int x = 0; x < options.width; ++x) {
                             render_pixel(x, static_cast<int>(y), places, work);
                         }
                         progress.advance(static_cast<std::uint64_t>(options.width));
                     }
                 });
    rendered.rays = rays;
    return rendered;
}

}  // namespace relight
