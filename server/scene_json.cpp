#include "server/scene_json.h"

#include <algorithm>
#include <numbers>

#include "core/io/readers.h"
#include "core/shade/raytrace.h"
#include "server/fields.h"
#include "server/json_text.h"
#include "server/light_json.h"
#include "server/output_json.h"

namespace relight {
namespace {

constexpr double degree = std::numbers::pi / 180.0;
constexpr double default_fov = 40.0 * degree;
constexpr std::size_t longest_part_name = 128;

bool is_id(std::string_view text)
{
    return text.size() == 64 &&
           text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

/// Inline arrays become a mesh when they fit each other.
Mesh inline_mesh(Fields& fields, InlineArrays arrays)
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
    Mesh mesh;
    mesh.format = "json";
    mesh.double_positions = float_loses_text(arrays.positions);
    mesh.positions = std::move(arrays.positions);
    mesh.faces.indices = std::move(arrays.faces);
    mesh.normals = std::move(arrays.normals);
    mesh.colors = std::move(arrays.colors);
    return mesh;
}

MeshSource parse_mesh(Fields& root, InlineArrays arrays, bool default_part)
{
    auto fields = root.object("mesh", "\"mesh\"");
    if (!fields) {
        if (!default_part) { root.need({"mesh"}); }
        return PartMesh{"mesh"};
    }
    if (fields->has("id") && fields->has("part")) {
        fields->fail(Fault::ConflictingFields, "part",
                     "\"id\" is given too; one of: id, part, positions");
    }
    if (fields->has("id")) {
        const std::string id = fields->text("id", 64).value_or("");
        if (!is_id(id)) {
            fields->fail(
                Fault::UnknownValue, "id",
                "found \"" + printable(id, 80) +
                    "\"; an id is the 64 lower-case hex digits that POST /v1/meshes answered");
        }
        fields->finish();
        return StoredMesh{id};
    }
    if (fields->has("part")) {
        PartMesh part{fields->text("part", longest_part_name).value_or("")};
        fields->finish();
        return part;
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
    // Point, spot and directional light need no samples a vertex: these change nothing, but must be
    // sound.
    fields.integer("samples", 1, 65536);
    if (!fields.is_null("target_standard_error")) {
        fields.number("target_standard_error", {0.0, 1e12, {}, true});
    }
    if (fields.integer("bounces", 0, 64).value_or(0) != 0) {
        fields.fail(Fault::NotAvailable, "bounces", "bounced light is not in this build; 0 is");
    }
    fields.finish();
    return options;
}

double parse_points(Fields fields)
{
    const double scale =
        fields.number("radius_scale", {0.0, 100.0, "local spacings", true}).value_or(1.5);
    fields.choice("normals", {"file"}, {"estimate"});
    fields.finish();
    return scale;
}

}  // namespace

Result<RelightRequest> parse_request(std::string_view json, const ParseLimits& limits,
                                     bool default_part)
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
            ParsedLights parsed = parse_lights(*lights, efficacy, errors);
            scene.units = parsed.units;
            scene.lights = std::move(parsed.lights);
        }
    }
    if (auto material = root.object("material", "a material")) {
        scene.material = parse_material(std::move(*material));
    }
    root.not_yet({"materials"}, "it has one \"material\" for the whole mesh");
    if (auto view = root.object("view", "\"view\"")) { scene.view = parse_view(std::move(*view)); }
    if (auto camera = root.object("camera", "\"camera\"")) {
        request.camera = parse_camera(std::move(*camera));
    }
    if (auto transport = root.object("transport", "\"transport\"")) {
        scene.transport = parse_transport(std::move(*transport));
    }
    if (auto points = root.object("points", "\"points\"")) {
        request.point_radius_scale = parse_points(std::move(*points));
    }
    if (auto display = root.object("display", "\"display\"")) {
        request.display = parse_display(std::move(*display));
    }
    request.output.quantities.color = true;
    if (auto output = root.object("output", "\"output\"")) {
        request.output = parse_output(std::move(*output), limits);
    }
    if (root.flag("receipt").value_or(false)) {
        root.fail(Fault::NotAvailable, "receipt", "receipts are not in this build; leave it out");
    }
    root.finish();
    if (errors) { return std::move(errors).take(); }
    return request;
}

Result<Scene> complete(const RelightRequest& request, const Bounds& bounds)
{
    Scene scene = request.scene;
    const CameraFields& given = request.camera;
    const double aspect = static_cast<double>(request.output.width) / request.output.height;
    scene.camera = frame(bounds, given.fov_y.value_or(default_fov), aspect);
    if (given.eye) {
        scene.camera.eye = *given.eye;
        scene.camera.target = given.target.value_or(bounds.centre());
        if (!normalize(scene.camera.eye - scene.camera.target)) {
            return make_error(Fault::ZeroDirection,
                              "the camera stands on its target; eye and target must differ",
                              "/camera/eye");
        }
    }
    if (given.up) { scene.camera.up = *given.up; }
    if (request.default_lights) {
        // A sun over the viewer's left shoulder: from behind the camera, above and to its left.
        const CameraAxes a = axes(scene.camera);
        const Vec3 toward_sun = Vec3(a.back) + 0.6 * Vec3(a.up) - 0.4 * Vec3(a.right);
        constexpr double sun_irradiance =
            3.0;  // E_perp [W/m^2]: white Lambert 0.8 facing it has L = 0.76
        scene.lights = {{"light_0", DirectionalLight{normalize(-toward_sun)},
                         Rgb::grey(sun_irradiance), true, true}};
    }
    return scene;
}

}  // namespace relight
