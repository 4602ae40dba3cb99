#include <cmath>

#include "core/io/writers.h"
#include "core/shade/shade.h"
#include "server/encode.h"
#include "server/json_text.h"
#include "server/json_tree.h"
#include "server/relight.h"
#include "server/relight_checks.h"
#include "server/timed.h"

namespace relight {
namespace {

std::string rgb_json(Rgb c)
{
    return json_of(Vec3{c.r, c.g, c.b});
}

/// The direction that stands for a light: a delta light's own; of others the middle of what their
/// sampling draws, and of skies the normal.
LightSample toward(const Light& light, const Receiver& receiver)
{
    if (is_delta(light.shape)) {
        const Arrival arrival = arrive(light.shape, receiver.p);
        return {arrival.wi, arrival.distance, {}, 0.0};
    }
    if (std::holds_alternative<EnvironmentLight>(light.shape)) {
        return {receiver.frame.n, std::numeric_limits<double>::infinity(), {}, 0.0};
    }
    return sample(light.shape, receiver.p, {0.5, 0.5}, 0.25);
}

/// What stands between the receiver and there: {"face": 3}, {"point": 7}, or null.
std::string blocker_json(const Stage& stage, const Scene& scene, const Light& light,
                         const Receiver& receiver, const LightSample& there)
{
    if (!there.wi || !scene.transport.shadows || !light.cast_shadows) { return "null"; }
    const bool on_mesh = std::holds_alternative<MeshLight>(light.shape);
    const double distance = on_mesh ? short_of_face(*stage.bvh, there.distance) : there.distance;
    const ShadowRay ray = shadow_ray(*stage.bvh, receiver, there.wi, distance, scene.transport);
    const Hit hit = stage.bvh->nearest(ray.origin, ray.direction, ray.from);
    if (hit.primitive == ~0U || hit.distance > ray.distance) { return "null"; }
    if (hit.is_point) { return ObjectWriter().count("point", hit.primitive).done(); }
    const auto& faces = stage.surface->triangle_face;
    return ObjectWriter()
        .count("face", faces.empty() ? hit.primitive : faces[hit.primitive])
        .number("distance", hit.distance)
        .done();
}

std::string terms_json(const Material& material, Vec3 wi, Vec3 wo, Rgb color)
{
    ObjectWriter json;
    for (const BsdfTerm& term : terms(material, wi, wo, color)) {
        json.raw(term.name, rgb_json(term.value));
    }
    return json.done();
}

/// Errors of a column at its one vertex, a band.
Rgb standard_error(const Column& column, Rgb power)
{
    const auto& error = column.standard_error;
    if (error.empty()) { return {}; }
    const auto band = [&](std::size_t b) {
        return static_cast<double>(error[std::min(b, error.size() - 1)]);
    };
    return Rgb{band(0), band(1), band(2)} * power;
}

struct Explained {
    std::string json;
    std::uint64_t rays = 0;
};

Explained explain_vertex(const Stage& stage, const Scene& scene,
                         std::span<const std::uint32_t> materials, std::size_t v)
{
    Explained explained;
    const std::size_t index = materials.empty() ? 0 : materials[v];
    const LocalMaterial local = vertex_material(stage, scene, materials, v);
    const Material& material = *local;
    const Rgb color = vertex_color(stage, v);
    const Receiver receiver = vertex_receiver(stage, v);
    const auto seen = seen_vertex(stage, scene, v);
    Transport transport;  // of this vertex alone
    transport.columns.resize(scene.lights.size());
    transport.drawn.resize(scene.lights.size());
    for (std::size_t l = 0; l < scene.lights.size(); ++l) {
        if (!scene.lights[l].enabled) { continue; }
        auto one = std::make_shared<Column>(column(stage, scene, l, v, v + 1));
        auto drawn = std::make_shared<Column>(drawn_radiance(stage, scene, l, v, v + 1, materials));
        explained.rays += one->rays + drawn->rays;
        transport.columns[l] = std::move(one);
        transport.drawn[l] = std::move(drawn);
    }
    const VertexRadiance radiance = vertex_radiance(stage, transport, scene, materials, v);
    Rgb E;
    Rgb L = radiance.own;
    ObjectWriter json;
    json.count("vertex", v)
        .raw("position", json_of(receiver.p - Point3{}))
        .raw("normal", receiver.frame.n ? json_of(receiver.frame.n) : "null")
        .count("material", index)
        .raw("own_radiance", rgb_json(L))
        .raw("toward_viewer",
             seen ? json_of(seen->receiver.frame.to_world(seen->wo)) : std::string("null"));
    std::string lights = "[";
    for (std::size_t l = 0; l < scene.lights.size(); ++l) {
        const Light& light = scene.lights[l];
        if (!light.enabled) { continue; }
        const Column& one = *transport.columns[l];
        const Rgb E_of_light = irradiance(one, light.power, 0);
        E += E_of_light;
        const LightSample there = toward(light, receiver);
        ObjectWriter item;
        item.text("light", light.name)
            .flag("sampled", !one.standard_error.empty())
            .raw("toward_light", there.wi ? json_of(there.wi) : "null")
            .number("cosine", there.wi ? dot(receiver.frame.n, there.wi) : 0.0)
            .raw("distance", std::isfinite(there.distance) && there.wi ? decimal(there.distance)
                                                                       : std::string("null"))
            .number("visibility", static_cast<double>(one.visible[0]))
            .raw("blocker", blocker_json(stage, scene, light, receiver, there))
            .raw("irradiance", rgb_json(E_of_light))
            .raw("standard_error", rgb_json(standard_error(one, light.power)));
        L += radiance.of_lights[l];
        if (seen) {
            item.raw("radiance", rgb_json(radiance.of_lights[l]));
            if (there.wi) {
                item.raw("brdf", terms_json(material, seen->receiver.frame.to_local(there.wi),
                                            seen->wo, color));
            }
        }
        lights += (lights.size() > 1 ? "," : "") + item.done();
    }
    const Rgbf E_total = to_float(E);
    const Rgbf L_total = to_float(L);
    std::string E_text;
    std::string L_text;
    append_json(E_text, E_total, 3);
    append_json(L_text, L_total, 3);
    // append_json writes rows: of one row, its own brackets.
    explained.json = json.raw("lights", lights + "]")
                         .raw("irradiance", E_text.substr(1, E_text.size() - 2))
                         .raw("radiance", L_text.substr(1, L_text.size() - 2))
                         .done();
    return explained;
}

}  // namespace

Result<Encoded> explain(RelightRequest request, const std::vector<Part>& parts,
                        const Workshop& workshop, Progress& progress)
{
    Timings timings;
    const auto tell = [&](const SetUp& made) -> Result<Encoded> {
        const Stage& stage = made.model.stage;
        const Scene& scene = made.scene;
        const std::size_t count = stage.mesh->positions.size();
        const auto materials = vertex_materials(stage, scene);
        Encoded encoded;
        encoded.media_type = "application/json";
        std::string vertices = "[";
        for (std::size_t i = 0; i < request.vertices.size(); ++i) {
            const std::uint64_t v = request.vertices[i];
            if (v >= count) {
                return make_error(Fault::IndexOutOfRange,
                                  "found " + std::to_string(v) + "; the mesh has " +
                                      std::to_string(count) + " vertices, counted from 0",
                                  "/vertices/" + std::to_string(i));
            }
            if (progress.stopped()) { return cancelled(); }
            const Explained one = explain_vertex(stage, scene, materials, v);
            encoded.rays += one.rays;
            vertices += (i > 0 ? "," : "") + one.json;
        }
        encoded.warnings = warnings_of(stage, scene, 0, Receivers::Vertices);
        encoded.body = sent_whole(ObjectWriter()
                                      .raw("units", units_json(scene.units))
                                      .raw("view", view_json(scene))
                                      .raw("vertices", vertices + "]")
                                      .raw("warnings", text_array(encoded.warnings))
                                      .done());
        return encoded;
    };
    auto encoded = timed(timings.total, [&] {
        return set_up(request, parts, workshop, timings, progress).and_then(tell);
    });
    if (encoded) { encoded->timings = timings; }
    return encoded;
}

}  // namespace relight
