#include "core/shade/shade.h"

#include <cmath>
#include <type_traits>

namespace relight {
namespace {

constexpr std::size_t block = 4096;

/// Direction from p to the viewer; "no direction" where the viewer stands at p.
Dir3 toward_viewer(const Scene& scene, Point3 p, Dir3 n)
{
    return std::visit(
        [&](const auto& view) {
            using ViewKind = std::decay_t<decltype(view)>;
            if constexpr (std::is_same_v<ViewKind, CameraView>) {
                return normalize(scene.camera.eye - p);
            } else if constexpr (std::is_same_v<ViewKind, DirectionView>) {
                return view.toward_viewer;
            } else {
                return n;
            }
        },
        scene.view);
}

/// Lo = sum over lights of f(wi, wo) E_light, on the side of the surface that faces the viewer.
/// Seen along its normal, a two-sided surface shows each light on the side that it lights:
/// Lambert's Lo = rho E / pi holds for the E of both sides.
Radiance outgoing(const Stage& stage, const Transport& transport, const Scene& scene, std::size_t v)
{
    Radiance L{};
    const Point3 p = stage.mesh->positions[v];
    Dir3 n = stage.surface->normals[v];
    const Dir3 to_viewer = toward_viewer(scene, p, n);
    const bool two_sided = scene.transport.two_sided;
    if (two_sided && dot(n, to_viewer) < 0.0) { n = -n; }
    if (!n || !(dot(n, to_viewer) > 0.0)) { return L; }
    const bool any_side = two_sided && std::holds_alternative<NormalView>(scene.view);
    const Frame frame = frame_around(n);
    const Vec3 wo = frame.to_local(to_viewer);
    const Rgb vertex_color =
        stage.mesh->colors.empty() ? Rgb::grey(1.0) : to_double(stage.mesh->colors[v]);
    for (std::size_t l = 0; l < transport.columns.size(); ++l) {
        const auto& column = transport.columns[l];
        if (column == nullptr || !(column->E[v] > 0.0F)) { continue; }
        const Light& light = scene.lights[l];
        const Irradiance E{light.power * static_cast<double>(column->E[v])};
        Vec3 wi = frame.to_local(arrive(light.shape, p).wi);
        if (any_side) { wi.z = std::abs(wi.z); }
        L += f(scene.material, wi, wo, vertex_color) * E;
    }
    return L;
}

}  // namespace

Shaded shade(const Stage& stage, const Transport& transport, const Scene& scene,
             const ShadeOptions& options, Progress& progress)
{
    const std::size_t vertices = stage.mesh->positions.size();
    Shaded shaded;
    shaded.irradiance.resize(vertices);
    if (options.radiance) { shaded.radiance.resize(vertices); }
    if (options.per_light) {
        shaded.per_light.assign(scene.lights.size(), std::vector<Rgbf>(vertices));
    }
    parallel_for(
        vertices, block, options.threads, progress, [&](std::size_t begin, std::size_t end) {
            for (std::size_t v = begin; v < end; ++v) {
                Rgb E;
                for (std::size_t l = 0; l < transport.columns.size(); ++l) {
                    if (transport.columns[l] == nullptr) { continue; }
                    const Rgb one =
                        scene.lights[l].power * static_cast<double>(transport.columns[l]->E[v]);
                    if (options.per_light) { shaded.per_light[l][v] = to_float(one); }
                    E += one;
                }
                shaded.irradiance[v] = to_float(E);
                if (options.radiance) {
                    shaded.radiance[v] = to_float(outgoing(stage, transport, scene, v).value);
                }
            }
        });
    return shaded;
}

}  // namespace relight
