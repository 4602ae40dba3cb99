#include <algorithm>
#include <charconv>
#include <numbers>
#include <set>
#include <unordered_map>
#include <utility>

#include "core/shade/raytrace.h"
#include "core/transport/textured.h"
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

/// Which of the request's "materials" each of the mesh's groups has, from 1; 0: none. A name goes
/// before an index that reads the same.
Result<std::vector<std::size_t>> own_material_of_groups(const RelightRequest& request,
                                                        const Mesh& mesh)
{
    const std::vector<std::string>& groups = mesh.materials;
    std::unordered_map<std::string_view, std::size_t> named;
    for (std::size_t i = 0; i < groups.size(); ++i) { named.try_emplace(groups[i], i); }
    std::vector<std::size_t> own_of(groups.size(), 0);
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
        std::size_t& own = own_of[*group];
        if (own != 0) {
            return make_error(Fault::ConflictingFields,
                              "\"" + printable(request.materials[own - 1].group) +
                                  "\" is the same group of faces; one material each",
                              "/materials" + pointer_step(key));
        }
        own = m + 1;
    }
    return own_of;
}

/// Gives the scene the materials of the request, and where it has none for a group, the file's own;
/// the first is for all that has neither.
std::optional<Error> set_materials(Scene& scene, const RelightRequest& request, const Asset& asset)
{
    const Mesh& mesh = asset.mesh;
    const auto own_of = own_material_of_groups(request, mesh);
    if (!own_of) { return own_of.error(); }
    const bool filed = request.default_material && !asset.materials.empty();
    if (filed && mesh.faces.count() == 0) { scene.materials = {asset.materials.front()}; }
    for (const GroupMaterial& own : request.materials) { scene.materials.push_back(own.material); }
    const std::size_t first_filed = scene.materials.size();
    if (filed) {
        scene.materials.insert(scene.materials.end(), asset.materials.begin(),
                               asset.materials.end());
        scene.textured.assign(scene.materials.size(), false);
        for (std::size_t m = first_filed; m < scene.materials.size(); ++m) {
            scene.textured[m] = !mesh.maps.empty();
        }
        scene.textured.front() = mesh.faces.count() == 0 && !mesh.maps.empty();
    }
    if (!filed && request.materials.empty()) { return {}; }
    for (std::size_t group = 0; group < own_of->size(); ++group) {
        const std::size_t own = (*own_of)[group];  // the first one stands before the request's
        const std::size_t index = own != 0 ? own : filed ? first_filed + group : 0;
        scene.material_of_group.push_back(static_cast<std::uint32_t>(index));
    }
    return {};
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
    const bool textured =
        std::any_of(mesh.maps.begin(), mesh.maps.end(),
                    [](const MaterialMaps& maps) { return maps.base_color.has_value(); });
    if (!mesh.colors.empty() || textured) { return {}; }
    const auto check = [](const Material& material,
                          const std::string& pointer) -> std::optional<Error> {
        const std::string field(vertex_color_field(material));
        if (field.empty()) { return {}; }
        return make_error(
            Fault::ConflictingFields,
            field + " is \"vertex\", but the mesh has neither colours nor a texture; give [r,g,b]",
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
    std::vector<Rgb> radiance;  // of each of the scene's materials, textures aside
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
        const std::size_t m = grouped ? scene.material_of_group[mesh.face_materials[face]] : 0;
        if (is_black(radiance[m])) { continue; }
        const bool textured = !scene.textured.empty() && scene.textured[m];
        const Rgb L = textured ? mean_emission(scene.materials[m], mesh, surface, t) : radiance[m];
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

/// Puts what the file brings in the place of the light at `place`, which stands for it: the lights
/// it lists, then its shining faces. Of either there may be none.
void insert_file_lights(Scene& scene, std::size_t place, const Asset& asset,
                        std::shared_ptr<const EmitterTable> faces)
{
    const Light wanted = scene.lights[place];
    std::set<std::string> taken;
    for (const Light& light : scene.lights) { taken.insert(light.name); }
    std::vector<Light> brought;
    for (Light light : asset.lights) {
        while (!taken.insert(light.name).second) { light.name += '_'; }
        light.power = light.power * wanted.power;
        light.enabled = wanted.enabled;
        light.cast_shadows = wanted.cast_shadows;
        brought.push_back(std::move(light));
    }
    if (faces != nullptr) {
        brought.push_back(wanted);
        brought.back().shape = MeshLight{std::move(faces)};
    }
    const auto at = scene.lights.begin() + static_cast<std::ptrdiff_t>(place);
    scene.lights.insert(scene.lights.erase(at), brought.begin(), brought.end());
}

/// The lights of the scene once the file is known: its own where they are asked for.
std::optional<Error> set_lights(Scene& scene, const RelightRequest& request, const Asset& asset,
                                const Mesh& mesh, const Surface& surface)
{
    for (const ClearSky& sky : request.skies) {
        scene.lights[sky.light].shape = make_sky(sky.toward_sun, sky.turbidity);
    }
    const auto stands_for_file = [](const Light& light) {
        return std::holds_alternative<MeshLight>(light.shape);
    };
    if (request.default_lights) {
        scene.lights = {{"light_0", MeshLight{}, Rgb::grey(1.0)}};
        scene.units = Units::Photometric;  // as glTF's lights and emissive faces are
    }
    const auto place = std::find_if(scene.lights.begin(), scene.lights.end(), stands_for_file);
    if (place == scene.lights.end()) { return {}; }
    const auto index = static_cast<std::size_t>(place - scene.lights.begin());
    auto faces = emitters_of(scene, mesh, surface);
    if (faces == nullptr && asset.lights.empty()) {
        if (request.default_lights) {
            scene.units = Units::Radiometric;
            scene.lights = {default_sun(scene.camera)};
            return {};
        }
        return make_error(
            Fault::MissingField,
            "the file brings no lights, and no face of it shines: give the material of "
            "some \"model\": \"metallic_roughness\" with \"emissive\": [r,g,b] and "
            "\"emissive_strength\"",
            "/lights" + pointer_step(index));
    }
    if (!asset.lights.empty() && scene.units == Units::Radiometric) {
        return make_error(Fault::MixedUnits,
                          "the file's own lights are in candela and lux, beside lights in watts: a "
                          "request is wholly in watts or wholly in lumens; "
                          "\"luminous_efficacy_lm_w\" converts the watts",
                          "/lights" + pointer_step(index));
    }
    insert_file_lights(scene, index, asset, std::move(faces));
    return {};
}

}  // namespace

Result<Scene> complete(const RelightRequest& request, const Asset& asset, const Mesh& mesh,
                       const Surface& surface)
{
    Scene scene = request.scene;
    auto camera = camera_of(request, surface.bounds);
    if (!camera) { return std::move(camera).error(); }
    scene.camera = *camera;
    if (auto error = set_materials(scene, request, asset)) { return std::move(*error); }
    if (auto error = missing_vertex_colors(request, asset.mesh)) { return std::move(*error); }
    for (Material& material : scene.materials) {
        if (auto* facets = std::get_if<CookTorrance>(&material)) {
            *facets = make_cook_torrance(std::move(*facets));
        }
    }
    if (auto error = set_lights(scene, request, asset, mesh, surface)) { return std::move(*error); }
    return scene;
}

}  // namespace relight
