#include "core/shade/shade.h"

#include <cmath>
#include <numbers>

#include "core/transport/receiver.h"

namespace relight {
namespace {

constexpr std::size_t block = 4096;

/// The `bands` values of one vertex as a colour.
Rgb at(const std::vector<float>& values, unsigned bands, std::size_t vertex)
{
    const auto band = [&](unsigned b) {
        return static_cast<double>(values[vertex * bands + (bands == 1 ? 0 : b)]);
    };
    return {band(0), band(1), band(2)};
}

}  // namespace

Rgb irradiance(const Column& column, Rgb power, std::size_t vertex)
{
    Rgb E = at(column.E, column.bands, vertex);
    if (!column.E_bounced.empty()) { E += at(column.E_bounced, 3, vertex); }
    return E * power;
}

Rgb radiance(const SeenVertex& seen, const Scene& scene, const Material& material, Rgb color,
             const Column& column, const Light& light, std::size_t vertex)
{
    const bool delta = is_delta(light.shape);
    if (E_tells_radiance(scene, material) && (!delta || !column.E_bounced.empty())) {
        return diffuse_albedo(material, color) * irradiance(column, light.power, vertex) *
               std::numbers::inv_pi;
    }
    Rgb L;
    if (!column.Lo.empty()) { L = at(column.Lo, 3, vertex) * light.power; }
    if (!delta || !(column.E[vertex] > 0.0F)) { return L; }
    // Lo = f(wi, wo) E on the side of the surface that faces the viewer. Seen along its normal, a
    // two-sided surface shows each light on the side that it lights: Lambert's Lo = rho E / pi
    // holds for the E of both sides.
    Vec3 wi = seen.receiver.frame.to_local(arrive(light.shape, seen.receiver.p).wi);
    if (seen.both_sides) { wi.z = std::abs(wi.z); }
    const Irradiance E{light.power * static_cast<double>(column.E[vertex])};
    return L + (f(material, wi, seen.wo, color) * E).value;
}

Rgb own_light(const SeenVertex& seen, const Stage& stage, const Material& material,
              std::size_t vertex)
{
    const bool front = dot(seen.receiver.frame.n, stage.surface->normals[vertex]) > 0.0;
    return front ? emission(material, seen.wo.z) : Rgb{};
}

namespace {

/// Lo = Le + sum over the lights.
Rgb outgoing(const Stage& stage, const Transport& transport, const Scene& scene,
             const Material& material, std::size_t v)
{
    const auto seen = seen_vertex(stage, scene, v);
    if (!seen) { return {}; }
    const Rgb color = vertex_color(stage, v);
    Rgb L = own_light(*seen, stage, material, v);
    for (std::size_t l = 0; l < transport.columns.size(); ++l) {
        const auto& column = transport.columns[l];
        if (column == nullptr) { continue; }
        L += radiance(*seen, scene, material, color, *column, scene.lights[l], v);
    }
    return L;
}

}  // namespace

Shaded shade(const Stage& stage, const Transport& transport, const Scene& scene,
             const ShadeOptions& options, Progress& progress)
{
    const std::size_t vertices = stage.mesh->positions.size();
    const auto materials = vertex_materials(stage, scene);
    Shaded shaded;
    shaded.irradiance.resize(vertices);
    if (options.radiance) { shaded.radiance.resize(vertices); }
    if (options.standard_error) { shaded.standard_error.resize(vertices); }
    if (options.per_light) {
        shaded.per_light.assign(scene.lights.size(), std::vector<Rgbf>(vertices));
    }
    const auto shade_vertex = [&](std::size_t v) {
        Rgb E;
        Rgb variance;
        for (std::size_t l = 0; l < transport.columns.size(); ++l) {
            const auto& column = transport.columns[l];
            if (column == nullptr) { continue; }
            const Rgb power = scene.lights[l].power;
            const Rgb one = irradiance(*column, power, v);
            if (options.per_light) { shaded.per_light[l][v] = to_float(one); }
            E += one;
            if (column->standard_error.empty()) { continue; }
            const unsigned bands = column->E_bounced.empty() ? column->bands : 3;
            const Rgb error = at(column->standard_error, bands, v) * power;
            variance += error * error;  // lights draw independent samples
        }
        shaded.irradiance[v] = to_float(E);
        if (options.standard_error) {
            shaded.standard_error[v] =
                to_float({std::sqrt(variance.r), std::sqrt(variance.g), std::sqrt(variance.b)});
        }
        if (options.radiance) {
            const LocalMaterial material = vertex_material(stage, scene, materials, v);
            shaded.radiance[v] = to_float(outgoing(stage, transport, scene, *material, v));
        }
    };
    parallel_for(vertices, block, options.threads, progress,
                 [&](std::size_t begin, std::size_t end) {
                     for (std::size_t v = begin; v < end; ++v) { shade_vertex(v); }
                 });
    return shaded;
}

}  // namespace relight
