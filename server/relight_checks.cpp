#include "server/relight_checks.h"

#include <algorithm>

#include "core/shade/sharp.h"
#include "core/transport/receiver.h"
#include "server/json_text.h"
#include "server/json_tree.h"

namespace relight {

namespace {

/// Most rays that one vertex may cost.
double rays_of_a_vertex(const Scene& scene, const Quantities& wanted, bool radiance)
{
    const double samples = scene.transport.samples;
    const double bounced = 2.0 * samples * scene.transport.bounces;  // a path's and the light's
    const bool glossy = radiance && std::any_of(scene.materials.begin(), scene.materials.end(),
                                                [&](const Material& material) {
                                                    return !E_tells_radiance(scene, material);
                                                });
    double rays = wanted.ambient_occlusion || wanted.sh ? samples : 0.0;
    for (const Light& light : scene.lights) {
        if (!light.enabled) { continue; }
        const bool delta = is_delta(light.shape);
        const double direct = delta ? 1.0 : samples;
        rays += direct + bounced;
        if (glossy) { rays += (delta ? 0.0 : direct) + bounced; }
    }
    return rays;
}

/// Most rays that one camera ray may cost.
double rays_of_a_path(const Scene& scene)
{
    const auto lights = static_cast<double>(scene.lights.size());
    return 1.0 + (2.0 + lights) * (1.0 + scene.transport.bounces);
}

/// OBJ and OFF have a place for normals.
bool is_mesh_with_normals(Format format)
{
    return format == Format::Obj || format == Format::Off;
}

/// The light has a surface, but one of no area: it can't shine.
bool is_flat_nothing(const LightShape& shape)
{
    if (const auto* rect = std::get_if<RectLight>(&shape)) { return area(*rect) == 0.0; }
    if (const auto* disk = std::get_if<DiskLight>(&shape)) { return area(*disk) == 0.0; }
    const auto* sphere = std::get_if<SphereLight>(&shape);
    return sphere != nullptr && area(*sphere) == 0.0;
}

}  // namespace

double rays_asked(const RelightRequest& request, Format format, const Scene& scene,
                  std::size_t vertices)
{
    const Output& output = request.output;
    if (is_image(format) && output.renderer == Renderer::Raytrace) {
        return static_cast<double>(output.width) * output.height * output.samples *
               rays_of_a_path(scene);
    }
    const Quantities& wanted = output.quantities;
    const bool radiance = wanted.color || wanted.radiance || is_image(format);
    return static_cast<double>(vertices) * rays_of_a_vertex(scene, wanted, radiance);
}

std::optional<Error> check(const RelightRequest& request, Format format, const SetUp& made,
                           const Workshop& workshop)
{
    const Stage& stage = made.model.stage;
    const Scene& scene = made.scene;
    const std::string& came_as = stage.mesh->format;
    if (format == Format::Las && (came_as != "las" || request.max_edge)) {
        return make_error(
            Fault::ConflictingFields,
            "las is the cloud's own file with its colours replaced, and this one came "
            "as " +
                came_as + "; take ply, or another format",
            "/output/format");
    }
    const auto vertices = static_cast<double>(stage.mesh->positions.size());
    const Output& output = request.output;
    const Quantities& wanted = output.quantities;
    const bool traced_image = is_image(format) && output.renderer == Renderer::Raytrace;
    const double pixels = static_cast<double>(output.width) * output.height;
    const double rays = rays_asked(request, format, scene, stage.mesh->positions.size());
    if (rays > static_cast<double>(workshop.rays)) {
        return make_error(Fault::OutOfRange,
                          "this asks for up to " + decimal(rays) + " rays; at most " +
                              std::to_string(workshop.rays) + " (limit --max-rays)",
                          traced_image ? "/output/samples" : "/transport/samples");
    }
    constexpr double column_bytes = 64, per_light_bytes = 12, vertex_bytes = 128,
                     pixel_bytes = 64;  // bytes
    const auto lights = static_cast<double>(scene.lights.size());
    const double a_light =
        column_bytes + (wanted.per_light ? 2 * per_light_bytes : 0) + (wanted.visibility ? 8 : 0);
    const double bytes =
        traced_image
            ? pixels * (pixel_bytes + (wanted.per_light ? 2 * per_light_bytes * lights : 0))
            : vertices * (vertex_bytes + lights * a_light);
    if (bytes > static_cast<double>(workshop.memory)) {
        return make_error(Fault::OutOfRange,
                          "this needs about " + decimal(bytes) +
                              " bytes of working memory; at most " +
                              std::to_string(workshop.memory) + " (limit --memory)",
                          traced_image ? "/output/height" : "/lights");
    }
    return {};
}

std::optional<Error> check_format(const Output& output, Format format)
{
    const Quantities& q = output.quantities;
    if (!is_image(format) && output.image_field) {
        return make_error(
            Fault::ConflictingFields,
            "only images have this field, and the answer is no image: add \"format\": \"png\"",
            "/output/" + *output.image_field);
    }
    const bool arrays = q.irradiance || q.radiance || q.visibility || q.ambient_occlusion || q.sh;
    const bool only_color = format == Format::Obj || format == Format::Off || format == Format::Las;
    if ((only_color || is_display_image(format)) && (arrays || q.per_light || q.standard_error ||
                                                     (q.normal && !is_mesh_with_normals(format)))) {
        return make_error(Fault::ConflictingFields,
                          "this format has a place for color alone; other quantities come as ply, "
                          "ply_ascii, glb, vtp, json or npz, or as layers of an exr",
                          "/output/quantities");
    }
    if (format == Format::Hdr && (q.standard_error || q.per_light || q.normal)) {
        return make_error(Fault::ConflictingFields,
                          "an hdr holds radiance alone; other quantities come as layers of an exr",
                          "/output/quantities");
    }
    if (format == Format::Jpeg && output.transparent) {
        return make_error(Fault::ConflictingFields,
                          "a jpeg cannot be transparent; take png, or another background",
                          "/output/background");
    }
    if (format == Format::Exr || format == Format::Hdr) {
        if (q.standard_error && output.samples < 4) {
            return make_error(Fault::OutOfRange,
                              "found " + std::to_string(output.samples) +
                                  "; the standard error of a pixel is told from at least 4 samples",
                              "/output/samples");
        }
        if (output.renderer == Renderer::Vtk) {
            return make_error(Fault::ConflictingFields,
                              "vtk draws display colours; an exr or hdr holds radiance: take "
                              "\"raytrace\", or \"format\": \"png\"",
                              "/output/renderer");
        }
        if (q.irradiance || q.visibility || q.ambient_occlusion || q.sh ||
            (q.color && output.names_quantities)) {
            return make_error(
                Fault::ConflictingFields,
                "an exr or hdr holds radiance, an exr as layers standard_error, per_light and "
                "normal; other quantities come as ply, ply_ascii, json or npz",
                "/output/quantities");
        }
    }
    return {};
}

std::vector<std::string> warnings_of(const Stage& stage, const Scene& scene, std::size_t clamped,
                                     Receivers receivers)
{
    std::vector<std::string> warnings;
    const auto dark = [](const Light& light) { return !light.enabled; };
    if (std::all_of(scene.lights.begin(), scene.lights.end(), dark)) {
        warnings.emplace_back("no light is on: everything is dark");
    }
    const Intake& intake = stage.surface->intake;
    if (intake.unlit_vertices > intake.absent_points) {
        warnings.push_back(
            std::to_string(intake.unlit_vertices - intake.absent_points) +
            " vertices have no normal and are unlit: no proper face uses them and the "
            "file brings none");
    }
    if (intake.normals_opposing > 0) {
        warnings.push_back(std::to_string(intake.normals_opposing) +
                           " vertices bring normals that point to the back of their faces");
    }
    if (intake.wound_inward && receivers == Receivers::Vertices && !scene.transport.two_sided) {
        warnings.emplace_back(
            "the faces wind inward, so their lit fronts look into the volume they enclose; for "
            "light "
            "on the outside send \"transport\": {\"two_sided\": true}");
    }
    if (stage.mesh->faces.count() == 0 && intake.normals_estimated > 0) {
        warnings.push_back("normals of " + std::to_string(intake.normals_estimated) +
                           " points were estimated from their neighbours");
    }
    if (intake.absent_points > 0) {
        warnings.push_back(std::to_string(intake.absent_points) +
                           " places of the file hold no point (NaN) and are unlit");
    }
    for (const Light& light : scene.lights) {
        if (light.enabled && is_flat_nothing(light.shape)) {
            warnings.push_back("light \"" + printable(light.name) +
                               "\" has no area: it gives no light");
        }
        const auto* sky = std::get_if<SkyLight>(&light.shape);
        if (sky != nullptr && light.enabled && -sky->sun.travel.y() < 0.0) {
            warnings.push_back("the sun of light \"" + printable(light.name) +
                               "\" is below the horizon (+Y is up)");
        }
    }
    for (const Material& material : scene.materials) {
        const auto* disney = std::get_if<Principled>(&material);
        if (disney != nullptr && disney->sheen > 0.0 && disney->metallic < 1.0) {
            warnings.emplace_back(
                "principled with sheen can reflect more light than it receives (as published)");
        }
    }
    if (clamped > 0) {
        warnings.push_back(std::to_string(clamped) +
                           " values are beyond single precision and were cut");
    }
    return warnings;
}

void warn_of_thin_shadows(std::vector<std::string>& warnings, const Stage& stage,
                          std::span<const Rgbf> irradiance, unsigned threads, Progress& progress)
{
    const std::vector<std::uint32_t> sharp =
        sharp_vertices(*stage.mesh, *stage.surface, irradiance, threads, progress);
    // On a mesh that is fine enough the edges of shadows cross few triangles: 1.3 % of 3,000
    // vertices.
    constexpr std::size_t usual = 50;  // one in so many
    if (sharp.empty() || sharp.size() < irradiance.size() / usual) { return; }
    constexpr std::size_t named = 8;
    std::string list;
    for (std::size_t i = 0; i < std::min(named, sharp.size()); ++i) {
        list += (i == 0 ? "" : ", ") + std::to_string(sharp[i]);
    }
    warnings.push_back(
        std::to_string(sharp.size()) + " vertices are lit very differently from a neighbour (" +
        list + (sharp.size() > named ? ", ..." : "") +
        "): a shadow may be thinner than a triangle; \"refine\": {\"max_edge\": ...} "
        "resolves it");
}

}  // namespace relight
