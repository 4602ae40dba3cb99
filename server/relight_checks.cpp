#include "server/relight_checks.h"

#include <algorithm>

#include "server/json_text.h"
#include "server/json_tree.h"

namespace relight {

std::optional<Error> check(const RelightRequest& request, Format format, const Stage& stage,
                           const Scene& scene, const Workshop& workshop)
{
    const bool from_vertex =
        std::visit([](const auto& m) { return m.albedo_from_vertex; }, scene.material);
    if (from_vertex && stage.mesh->colors.empty()) {
        return make_error(Fault::ConflictingFields,
                          "albedo is \"vertex\", but the mesh has no colours", "/material/albedo");
    }
    const auto vertices = static_cast<double>(stage.mesh->positions.size());
    const auto lights = static_cast<double>(scene.lights.size());
    const Output& output = request.output;
    const bool traced_image = is_image(format) && output.renderer == Renderer::Raytrace;
    const double pixels = static_cast<double>(output.width) * output.height;
    const double rays = traced_image ? pixels * output.samples * (1.0 + lights) : vertices * lights;
    if (rays > static_cast<double>(workshop.rays)) {
        return make_error(Fault::OutOfRange,
                          "this asks for up to " + decimal(rays) + " rays; at most " +
                              std::to_string(workshop.rays) + " (limit --max-rays)",
                          traced_image ? "/output/samples" : "/lights");
    }
    constexpr double column_bytes = 5, per_light_bytes = 12, vertex_bytes = 64,
                     pixel_bytes = 32;  // bytes
    const double a_light = column_bytes +
                           (request.output.quantities.per_light ? 2 * per_light_bytes : 0) +
                           (request.output.quantities.visibility ? 8 : 0);
    const double bytes =
        traced_image ? pixels * pixel_bytes : vertices * (vertex_bytes + lights * a_light);
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
    if (is_image(format) &&
        (q.irradiance || q.radiance || q.visibility || q.normal || q.per_light)) {
        return make_error(Fault::ConflictingFields,
                          "a PNG shows color; other quantities come as ply, ply_ascii, json or npz",
                          "/output/quantities");
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
    if (intake.unlit_vertices > 0) {
        warnings.push_back(
            std::to_string(intake.unlit_vertices) +
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
    if (clamped > 0) {
        warnings.push_back(std::to_string(clamped) +
                           " values are beyond single precision and were cut");
    }
    return warnings;
}

}  // namespace relight
