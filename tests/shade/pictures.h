#pragma once

#include <cmath>

#include "core/shade/raytrace.h"
#include "core/transport/budget.h"
#include "tests/scenes.h"

namespace relight::test {

inline Rendered picture(const Stage& stage, const Scene& scene, const RaytraceOptions& options)
{
    Progress progress;
    return raytrace(stage, scene, options, progress);
}

/// A camera at `eye` that sees no more of p than a pinhead.
inline Camera pinhead(Point3 eye, Point3 p, double fov_y = 1e-6)
{
    return {eye, p, {0.31, 0.87, 0.38}, fov_y};
}

/// Mean of a picture's pixels and its standard error, a band.
struct Mean {
    Rgb value, error;
};
/// @param samples a pixel: all pixels together have so many replicates that Student's factor of the
/// few of one pixel is taken out again
inline Mean mean_of(const Rendered& rendered, int samples)
{
    Rgb sum, variance;
    for (std::size_t i = 0; i < rendered.image.pixels.size(); ++i) {
        const Rgb error = to_double(rendered.standard_error[i]);
        sum += to_double(rendered.image.pixels[i]);
        variance += error * error;
    }
    const double n = static_cast<double>(rendered.image.pixels.size());
    const double factor = student_factor(static_cast<unsigned>(std::ceil(std::sqrt(samples)))) * n;
    return {sum / n,
            Rgb{std::sqrt(variance.r), std::sqrt(variance.g), std::sqrt(variance.b)} / factor};
}
inline Mean mean_picture(const Stage& stage, const Scene& scene, const RaytraceOptions& options)
{
    return mean_of(picture(stage, scene, options), options.samples);
}

/// A square of side 2 r around p that faces n: four corners of its own, two triangles.
inline Mesh patch(Point3 p, Dir3 n, double r)
{
    const Frame frame = frame_around(n);
    const Vec3 x = Vec3(frame.x) * r, y = Vec3(frame.y) * r;
    return mesh_of({p - x - y, p + x - y, p + x + y, p - x + y}, {0, 1, 2, 0, 2, 3});
}

/// A box whose six faces have their own corners, so that they are flat, and look inward.
inline Mesh room(Point3 lo, Point3 hi)
{
    const Mesh shared = box(lo, hi);
    Mesh mesh = mesh_of({}, {});
    for (std::size_t t = 0; t < shared.faces.indices.size(); t += 3) {
        for (const std::size_t corner : {0U, 2U, 1U}) {
            mesh.faces.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
            mesh.positions.push_back(shared.positions[shared.faces.indices[t + corner]]);
        }
    }
    return mesh;
}

/// All shining triangles of a scene with one material, as a light.
inline Light light_of_faces(const Stage& stage, const Material& material)
{
    std::vector<Emitter> emitters;
    for (std::size_t t = 0; t < stage.surface->triangles.size(); ++t) {
        const auto [a, b, c] = stage.surface->triangles[t];
        const auto& p = stage.mesh->positions;
        emitters.push_back({{p[a], p[b], p[c]}, static_cast<std::uint32_t>(t), emission(material)});
    }
    return light_of(MeshLight{std::make_shared<const EmitterTable>(std::move(emitters))});
}

/// A rectangle by its corners, shining toward (v1 - v0) x (v2 - v0).
inline RectLight rect_of(Point3 v0, Point3 v1, Point3 v3)
{
    const Vec3 u = v1 - v0, v = v3 - v0;
    return {v0 + u * 0.5 + v * 0.5, u, v, false};
}

}  // namespace relight::test
