#include <charconv>
#include <numbers>
#include <unordered_map>
#include <utility>

#include "core/shade/raytrace.h"
#include "server/json_text.h"
#include "server/json_tree.h"
#include "server/scene_json.h"

namespace relight {
namespace {

Result<Camera> camera_of(const RelightRequest& request, const Bounds& bounds)
{
    constexpr double default_fov = 40.0 * std::numbers::pi / 180.0;
    const CameraFields& given = request.camera;
    const double aspect = static_cast<double>(request.output.width) / request.output.height;
    Camera camera = frame(bounds, given.fov_y.value_or(default_fov), aspect);
    if (given.eye) {
        camera.eye = *given.eye;
        camera.target = given.target.value_or(bounds.centre());
        if (!normalize(camera.eye - camera.target)) {
            return make_error(Fault::ZeroDirection,
                              "the camera stands on its target; eye and target must differ",
                              "/camera/eye");
        }
    }
    if (given.up) { camera.up = *given.up; }
    return camera;
}

/// The mesh's groups, for a message: the first of them, and how many there are.
std::string listed(const std::vector<std::string>& groups)
{
    if (groups.empty()) {
        return "this mesh names no materials; \"material\" is for the whole of it";
    }
    constexpr std::size_t shown = 8;
    std::string list;
    for (std::size_t i = 0; i < groups.size() && i < shown; ++i) {
        list += (i == 0 ? "\"" : ", \"") + printable(groups[i]) + '"';
    }
    return "this mesh has " + list + (groups.size() > shown ? ", …" : "") +
           ", or their indices 0.." + std::to_string(groups.size() - 1);
}

/// "3" as an index below `count`.
std::optional<std::size_t> index_of(const std::string& key, std::size_t count)
{
    std::size_t index = 0;
    const char* end = key.data() + key.size();
    const auto [stop, problem] = std::from_chars(key.data(), end, index);
    if (problem != std::errc() || stop != end || index >= count) { return {}; }
    return index;
}

/// Index into Scene::materials of each of the mesh's groups; empty if the request has none of its
/// own. A name goes before an index that reads the same.
Result<std::vector<std::uint32_t>> materials_of_groups(const RelightRequest& request,
                                                       const Mesh& mesh)
{
    if (request.materials.empty()) { return std::vector<std::uint32_t>(); }
    const std::vector<std::string>& groups = mesh.materials;
    std::unordered_map<std::string_view, std::size_t> named;
    for (std::size_t i = 0; i < groups.size(); ++i) { named.try_emplace(groups[i], i); }
    std::vector<std::uint32_t> material_of(groups.size(), 0);
    for (std::size_t m = 0; m < request.materials.size(); ++m) {
        const std::string& key = request.materials[m].group;
        const auto found = named.find(key);
        const auto group =
            found == named.end() ? index_of(key, groups.size()) : std::optional(found->second);
        if (!group) {
            return make_error(Fault::UnknownValue,
                              "found \"" + printable(key) + "\"; " + listed(groups),
                              "/materials" + pointer_step(key));
        }
        std::uint32_t& index = material_of[*group];
        if (index != 0) {
            return make_error(Fault::ConflictingFields,
                              "\"" + printable(request.materials[index - 1].group) +
                                  "\" is the same group of faces; one material each",
                              "/materials" + pointer_step(key));
        }
        index = static_cast<std::uint32_t>(m + 1);
    }
    return material_of;
}

/// The field by which a material takes the vertex colours; empty if it does not.
std::string_view vertex_color_field(const Material& material)
{
    return std::visit(
        [](const auto& m) -> std::string_view {
            if constexpr (requires { m.albedo_from_vertex; }) {
                return m.albedo_from_vertex ? "albedo" : "";
            } else {
                return m.base_color_from_vertex ? "base_color" : "";
            }
        },
        material);
}

std::optional<Error> missing_vertex_colors(const RelightRequest& request, const Mesh& mesh)
{
    if (!mesh.colors.empty()) { return {}; }
    const auto check = [](const Material& material,
                          const std::string& pointer) -> std::optional<Error> {
        const std::string field(vertex_color_field(material));
        if (field.empty()) { return {}; }
        return make_error(Fault::ConflictingFields,
                          field + " is \"vertex\", but the mesh has no colours; give [r,g,b]",
                          pointer + "/" + field);
    };
    if (auto error = check(request.scene.materials.front(), "/material")) { return error; }
    for (const GroupMaterial& own : request.materials) {
        if (auto error = check(own.material, "/materials" + pointer_step(own.group))) {
            return error;
        }
    }
    return {};
}

bool is_black(Rgb L)
{
    return !(L.r > 0.0 || L.g > 0.0 || L.b > 0.0);
}

/// The triangles of shining materials; null if there are none.
std::shared_ptr<const EmitterTable> emitters_of(const Scene& scene, const Mesh& mesh,
                                                const Surface& surface)
{
    std::vector<Rgb> radiance;  // of each of the scene's materials
    bool dark = true;
    for (const Material& material : scene.materials) {
        radiance.push_back(emission(material));
        dark = dark && is_black(radiance.back());
    }
    if (dark) { return nullptr; }
    const bool grouped = !scene.material_of_group.empty() && !mesh.face_materials.empty();
    std::vector<Emitter> emitters;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const std::size_t face = surface.triangle_face.empty() ? t : surface.triangle_face[t];
        const Rgb L = radiance[grouped ? scene.material_of_group[mesh.face_materials[face]] : 0];
        if (is_black(L)) { continue; }
        auto [a, b, c] = surface.triangles[t];
        // Filed normals say which side is the front, before the winding does.
        const Vec3 wound =
            cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
        const Vec3 front =
            Vec3(surface.normals[a]) + Vec3(surface.normals[b]) + Vec3(surface.normals[c]);
        if (dot(wound, front) < 0.0) { std::swap(b, c); }
        emitters.push_back({{mesh.positions[a], mesh.positions[b], mesh.positions[c]},
                            static_cast<std::uint32_t>(t),
                            L});
    }
    auto table = std::make_shared<const EmitterTable>(std::move(emitters));
    return table->size() == 0 ? nullptr : table;
}

/// A sun over the viewer's left shoulder: from behind the camera, above and to its left.
Light default_sun(const Camera& camera)
{
    constexpr double sun_irradiance = 3.0;  // E_perp [W/m^2]: Lambert 0.8 facing it has L = 0.76
    const CameraAxes a = axes(camera);
    const Vec3 toward_sun = Vec3(a.back) + 0.6 * Vec3(a.up) - 0.4 * Vec3(a.right);
    return {"light_0", DirectionalLight{normalize(-toward_sun)}, Rgb::grey(sun_irradiance)};
}

}  // namespace

Result<Scene> complete(const RelightRequest& request, const Mesh& mesh, const Surface& surface)
{
    Scene scene = request.scene;
    auto camera = camera_of(request, surface.bounds);
    if (!camera) { return std::move(camera).error(); }
    scene.camera = *camera;

    auto material_of_group = materials_of_groups(request, mesh);
    if (!material_of_group) { return std::move(material_of_group).error(); }
    scene.material_of_group = std::move(*material_of_group);
    if (auto error = missing_vertex_colors(request, mesh)) { return std::move(*error); }
    for (const GroupMaterial& own : request.materials) { scene.materials.push_back(own.material); }
    for (Material& material : scene.materials) {
        if (auto* facets = std::get_if<CookTorrance>(&material)) {
            *facets = make_cook_torrance(std::move(*facets));
        }
    }

    for (const ClearSky& sky : request.skies) {
        scene.lights[sky.light].shape = make_sky(sky.toward_sun, sky.turbidity);
    }
    if (request.default_lights) {
        if (auto table = emitters_of(scene, mesh, surface)) {
            scene.units = Units::Photometric;  // as glTF's emissive faces are
            scene.lights = {{"light_0", MeshLight{std::move(table)}}};
        } else {
            scene.lights = {default_sun(scene.camera)};
        }
    }
    for (std::size_t i = 0; i < scene.lights.size(); ++i) {
        auto* own = std::get_if<MeshLight>(&scene.lights[i].shape);
        if (own == nullptr || own->table != nullptr) { continue; }
        own->table = emitters_of(scene, mesh, surface);
        if (own->table == nullptr) {
            return make_error(Fault::MissingField,
                              "no face of this mesh shines: give the material of some "
                              "\"model\": \"metallic_roughness\" with \"emissive\": [r,g,b] and "
                              "\"emissive_strength\"",
                              "/lights" + pointer_step(i));
        }
    }
    return scene;
}

}  // namespace relight
