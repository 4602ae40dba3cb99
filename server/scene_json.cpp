#include "server/scene_json.h"

#include <algorithm>
#include <numbers>

#include "core/geometry/precision.h"
#include "core/io/readers.h"
#include "server/fields.h"
#include "server/file_source.h"
#include "server/json_text.h"
#include "server/light_json.h"
#include "server/output_json.h"

namespace relight {
namespace {

constexpr double degree = std::numbers::pi / 180.0;
/// Inline arrays become a mesh when they fit each other.
InlineMesh inline_mesh(Fields& fields, InlineArrays arrays)
{
    for (const std::string_view name : {"positions", "faces", "normals", "colors"}) {
        const Json* json = fields.find(name);
        if (json != nullptr && !std::holds_alternative<BulkArray>(json->value)) {
            fields.fail(Fault::WrongType, name,
                        "found " + description_of(*json) + "; " + std::string(name) +
                            " is an array of rows of 3 numbers");
        }
    }
    fields.need({"positions"});
    fields.finish();
    const std::size_t count = arrays.positions.size();
    if (count == 0) {
        fields.fail(Fault::NoGeometry, "positions", "found no positions; at least 1");
    }
    for (const auto& [name, size] :
         {std::pair{"normals", arrays.normals.size()}, std::pair{"colors", arrays.colors.size()}}) {
        if (fields.has(name) && size != count) {
            fields.fail(Fault::WrongLength, name,
                        "found " + std::to_string(size) + " rows for " + std::to_string(count) +
                            " positions; one row a position");
        }
    }
    const auto outside = std::find_if(arrays.faces.begin(), arrays.faces.end(),
                                      [&](std::uint32_t index) { return index >= count; });
    if (outside != arrays.faces.end()) {
        const auto at = static_cast<std::size_t>(outside - arrays.faces.begin());
        fields.errors().report(
            make_error(Fault::IndexOutOfRange,
                       "found " + std::to_string(*outside) + "; there are " +
                           std::to_string(count) + " positions, counted from 0",
                       fields.pointer_to("faces") + pointer_step(at / 3) + pointer_step(at % 3)));
    }
    const auto asset = std::make_shared<Asset>();
    Mesh& mesh = asset->mesh;
    mesh.format = "json";
    mesh.double_positions = float_loses_text(arrays.positions);
    mesh.positions = std::move(arrays.positions);
    mesh.faces.indices = std::move(arrays.faces);
    mesh.normals = std::move(arrays.normals);
    mesh.colors = std::move(arrays.colors);
    return asset;
}

MeshSource parse_mesh(Fields& root, InlineArrays arrays, bool default_part)
{
    auto fields = root.object("mesh", "\"mesh\"");
    if (!fields) {
        if (!default_part) { root.need({"mesh"}); }
        return PartMesh{"mesh"};
    }
    if (auto file = parse_file_source(*fields, "POST /v1/meshes")) {
        return std::visit([](auto& source) -> MeshSource { return std::move(source); }, *file);
    }
    return inline_mesh(*fields, std::move(arrays));
}

View parse_view(Fields fields)
{
    const auto type = fields.choice("type", {"normal", "camera", "direction"});
    fields.need({"type"});
    View view = NormalView{};
    if (type == "camera") { view = CameraView{}; }
    if (type == "direction") {
        fields.need({"toward_viewer"});
        view = DirectionView{fields.direction("toward_viewer").value_or(Dir3{})};
    }
    fields.finish();
    return view;
}

CameraFields parse_camera(Fields fields)
{
    CameraFields camera;
    camera.eye = fields.point("eye");
    camera.target = fields.point("target");
    camera.up = fields.direction("up");
    const auto fov = fields.number("fov_y_deg", {0.01, 179.0, "degrees"});
    if (fov) { camera.fov_y = *fov * degree; }
    if (fields.has("target")) { fields.need({"eye"}); }
    fields.finish();
    return camera;
}

TransportOptions parse_transport(Fields fields)
{
    TransportOptions options;
    options.shadows = fields.flag("shadows").value_or(options.shadows);
    options.two_sided = fields.flag("two_sided").value_or(options.two_sided);
    if (fields.choice("terminator", {"none", "smooth"}) == "none") {
        options.terminator = Terminator::None;
    }
    if (!fields.is_null("max_distance")) {
        options.max_distance = fields.number("max_distance", {0.0, 1e15, "length units", true});
    }
    options.seed =
        static_cast<std::uint64_t>(fields.integer("seed", 0, std::int64_t{1} << 53).value_or(0));
    if (!fields.is_null("target_standard_error")) {
        options.target_standard_error =
            fields.number("target_standard_error", {0.0, 1e12, "W/m2 or lx", true});
    }
    constexpr unsigned enough = 4096;  // for a target: what most vertices never need
    if (options.target_standard_error) { options.samples = enough; }
    options.samples =
        static_cast<unsigned>(fields.integer("samples", 1, 65536).value_or(options.samples));
    options.bounces = static_cast<unsigned>(fields.integer("bounces", 0, 64).value_or(0));
    fields.finish();
    return options;
}

Points parse_points(Fields fields)
{
    Points points;
    points.radius_scale = fields.number("radius_scale", {0.0, 100.0, "local spacings", true})
                              .value_or(points.radius_scale);
    if (const auto normals = fields.choice("normals", {"file", "estimate"})) {
        points.estimate = *normals == "estimate";
    }
    points.viewpoint = fields.point("viewpoint");
    if (points.viewpoint && points.estimate == false) {
        fields.fail(Fault::ConflictingFields, "viewpoint",
                    "it turns estimated normals, and \"normals\" is \"file\"; leave one out");
    }
    fields.finish();
    return points;
}

double parse_refine(Fields fields)
{
    fields.need({"max_edge"});
    const auto max_edge = fields.number("max_edge", {0.0, 1e15, "length units", true});
    fields.finish();
    return max_edge.value_or(1.0);
}

/// "vertices" of a request to explain: indices, checked against the mesh later.
std::vector<std::uint64_t> parse_vertices(Fields& root)
{
    constexpr std::size_t most = 1000;
    root.need({"vertices"});
    const JsonArray* given = root.array("vertices");
    std::vector<std::uint64_t> vertices;
    if (given == nullptr) { return vertices; }
    if (given->empty() || given->size() > most) {
        root.fail(
            Fault::WrongLength, "vertices",
            "found " + std::to_string(given->size()) + " vertices; 1 to " + std::to_string(most));
        return vertices;
    }
    for (std::size_t i = 0; i < given->size(); ++i) {
        const std::string place = std::to_string(i);
        const Json item{JsonObject{{place, (*given)[i]}}};
        Fields one(item, root.pointer_to("vertices"), "a vertex", root.errors());
        vertices.push_back(
            static_cast<std::uint64_t>(one.integer(place, 0, std::int64_t{1} << 53).value_or(0)));
    }
    return vertices;
}

}  // namespace

Result<RelightRequest> parse_request(std::string_view json, const ParseLimits& limits,
                                     bool default_part, bool explain)
{
    auto tree = parse_json(json, limits.vertices, limits.faces);
    if (!tree) { return std::move(tree).error(); }
    FirstError errors;
    RelightRequest request;
    Scene& scene = request.scene;
    Fields root(tree->root, "", "the request", errors);
    request.mesh = parse_mesh(root, std::move(tree->mesh), default_part);
    scene.length_unit_m = root.number("length_unit_m", {1e-12, 1e12, "metres"}).value_or(1.0);
    const auto efficacy = root.number("luminous_efficacy_lm_w", {0.0, 683.0, "lm/W", true});
    if (const JsonArray* lights = root.array("lights")) {
        request.default_lights = false;
        if (lights->size() > limits.lights) {
            root.fail(Fault::OutOfRange, "lights",
                      "found " + std::to_string(lights->size()) + " lights; at most " +
                          std::to_string(limits.lights) + " (limit --max-lights)");
        } else {
            ParsedLights parsed = parse_lights(*lights, efficacy, scene.length_unit_m, errors);
            scene.units = parsed.units;
            scene.lights = std::move(parsed.lights);
            request.light_files = std::move(parsed.files);
            request.skies = std::move(parsed.skies);
        }
    }
    if (auto material = root.object("material", "a material")) {
        scene.materials = {parse_material(std::move(*material))};
        request.default_material = false;
    }
    if (const Json* materials = root.find("materials")) {
        request.materials = parse_materials(*materials, root.pointer_to("materials"), errors);
    }
    if (auto view = root.object("view", "\"view\"")) { scene.view = parse_view(std::move(*view)); }
    if (auto camera = root.object("camera", "\"camera\"")) {
        request.camera = parse_camera(std::move(*camera));
    }
    if (auto transport = root.object("transport", "\"transport\"")) {
        scene.transport = parse_transport(std::move(*transport));
    }
    if (auto points = root.object("points", "\"points\"")) {
        request.points = parse_points(std::move(*points));
    }
    if (auto refine = root.object("refine", "\"refine\"")) {
        request.max_edge = parse_refine(std::move(*refine));
    }
    if (auto display = root.object("display", "\"display\"")) {
        request.display = parse_display(std::move(*display));
    }
    request.output.quantities.color = true;
    if (auto output = root.object("output", "\"output\"")) {
        request.output = parse_output(std::move(*output), limits);
    }
    if (explain) { request.vertices = parse_vertices(root); }
    request.receipt = root.flag("receipt").value_or(false);
    if (explain && request.receipt) {
        root.fail(Fault::NotAvailable, "receipt", "explanations carry none; leave it out");
    }
    root.finish();
    if (errors) { return std::move(errors).take(); }
    return request;
}

}  // namespace relight
