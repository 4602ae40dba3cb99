#include "server/column_key.h"

#include <algorithm>
#include <concepts>
#include <cstring>
#include <type_traits>

#include "server/sha256.h"

namespace relight {
namespace {

/// A text of values, bit for bit. Structs are taken apart by name, so that one that gains a field
/// does not compile until the field has its place here.
class KeyText {
  public:
    explicit KeyText(const FileNames& names) : names_(names) {}

    template <class... Values>
    KeyText& add(const Values&... values)
    {
        (one(values), ...);
        return *this;
    }
    const std::string& text() const { return text_; }

  private:
    template <class T>
    requires std::is_arithmetic_v<T> || std::is_enum_v<T>
    void one(T value)
    {
        char bytes[sizeof value];
        if constexpr (std::floating_point<T>) { value += T{}; }  // -0 is 0
        std::memcpy(bytes, &value, sizeof value);
        text_.append(bytes, sizeof value);
    }
    void one(const std::string& text)
    {
        one(text.size());
        text_ += text;
    }
    template <class T>
    void one(const std::optional<T>& value)
    {
        one(value.has_value());
        if (value) { one(*value); }
    }
    template <class T>
    void one(const std::vector<T>& values)
    {
        one(values.size());
        for (const T& value : values) { one(value); }
    }
    template <class... Kinds>
    void one(const std::variant<Kinds...>& kinds)
    {
        one(kinds.index());
        std::visit([this](const auto& kind) { this->one(kind); }, kinds);
    }
    template <class T>
    void file(const std::shared_ptr<const T>& made)
    {
        const auto name = names_.find(made.get());
        one(name == names_.end() ? std::string() : name->second);
    }

    void one(Rgb c) { add(c.r, c.g, c.b); }
    void one(Vec3 v) { add(v.x, v.y, v.z); }
    void one(Point3 p) { one(p - Point3{}); }
    void one(Dir3 d) { one(Vec3(d)); }

    void one(const PointLight& light)
    {
        const auto& [position, range] = light;
        add(position, range);
    }
    void one(const SpotLight& light)
    {
        const auto& [position, axis, inner, outer, range] = light;
        add(position, axis, inner, outer, range);
    }
    void one(const DirectionalLight& light)
    {
        const auto& [travel, half_angle] = light;
        add(travel, half_angle);
    }
    void one(const IesLight& light)
    {
        const auto& [position, axis, h0, profile] = light;
        add(position, axis, h0);
        file(profile);
    }
    void one(const RectLight& light)
    {
        const auto& [center, edge_u, edge_v, two_sided] = light;
        add(center, edge_u, edge_v, two_sided);
    }
    void one(const DiskLight& light)
    {
        const auto& [center, normal, radius] = light;
        add(center, normal, radius);
    }
    void one(const SphereLight& light)
    {
        const auto& [center, radius] = light;
        add(center, radius);
    }
    void one(const EnvironmentLight& light)
    {
        const auto& [map, rotation] = light;
        file(map);
        add(map != nullptr, rotation);
    }
    void one(const SkyLight& light)
    {
        const auto& [dome, sun, sun_E_perp, turbidity] = light;  // the dome follows from sun and
        add(sun, turbidity);                                     // turbidity
    }
    /// Its table is made of the model and of how much its materials shine: see with_emission().
    static void one(const MeshLight& /*light*/) {}

    void one(const NormalView& /*view*/) {}
    void one(const CameraView& /*view*/) {}
    void one(const DirectionView& view)
    {
        const auto& [toward_viewer] = view;
        add(toward_viewer);
    }

    void one(const Lambert& material)
    {
        const auto& [albedo, from_vertex] = material;
        add(albedo, from_vertex);
    }
    void one(const OrenNayar& material)
    {
        const auto& [albedo, from_vertex, sigma] = material;
        add(albedo, from_vertex, sigma);
    }
    void one(const SchlickF0& fresnel)
    {
        const auto& [F0] = fresnel;
        add(F0);
    }
    void one(const DielectricIor& fresnel)
    {
        const auto& [ior] = fresnel;
        add(ior);
    }
    void one(const ConductorEtaK& fresnel)
    {
        const auto& [eta, k] = fresnel;
        add(eta, k);
    }
    void one(const CookTorrance& material)
    {
        // The tables follow from the rest.
        const auto& [albedo, from_vertex, fresnel, distribution, alpha_x, alpha_y, gamma, shadowing,
                     multiscatter, masking, lost, F_avg] = material;
        add(albedo, from_vertex, fresnel, distribution, alpha_x, alpha_y, gamma, shadowing,
            multiscatter);
    }
    void one(const Principled& material)
    {
        const auto& [base_color, from_vertex, metallic, subsurface, specular, roughness,
                     specular_tint, anisotropic, sheen, sheen_tint, clearcoat, clearcoat_gloss] =
            material;
        add(base_color, from_vertex, metallic, subsurface, specular, roughness, specular_tint,
            anisotropic, sheen, sheen_tint, clearcoat, clearcoat_gloss);
    }
    void one(const MetallicRoughness& material)
    {
        const auto& [base_color, from_vertex, metallic, roughness, ior, specular, specular_color,
                     clearcoat, clearcoat_roughness, sheen_color, sheen_roughness,
                     anisotropy_strength, anisotropy_rotation, emissive, emissive_strength] =
            material;
        add(base_color, from_vertex, metallic, roughness, ior, specular, specular_color, clearcoat,
            clearcoat_roughness, sheen_color, sheen_roughness, anisotropy_strength,
            anisotropy_rotation, emissive, emissive_strength);
    }

    const FileNames& names_;
    std::string text_;
};

/// What the scene says of shadows, as far as it is asked.
void add_shadows(KeyText& key, const TransportOptions& options, bool shadowed)
{
    key.add(shadowed);
    if (shadowed) { key.add(options.max_distance); }
}

void add_materials(KeyText& key, const Scene& scene)
{
    key.add(scene.materials, scene.material_of_group);
    for (const bool textured : scene.textured) { key.add(textured); }
}

/// How far each sampled light is drawn when a standard error is asked for: it depends on its power
/// and on how many others there are.
void add_target(KeyText& key, const Scene& scene, const Light& light)
{
    key.add(scene.transport.target_standard_error);
    if (!scene.transport.target_standard_error) { return; }
    const auto sampled =
        std::count_if(scene.lights.begin(), scene.lights.end(), [&](const Light& other) {
            return other.enabled && (!is_delta(other.shape) || scene.transport.bounces > 0);
        });
    key.add(light.power, sampled);
}

void add_light(KeyText& key, const Scene& scene, std::size_t number)
{
    const TransportOptions& options = scene.transport;
    const Light& light = scene.lights[number];
    const bool delta = is_delta(light.shape);
    key.add(light.shape, options.two_sided, options.bounces);
    add_shadows(key, options, options.shadows && light.cast_shadows);
    const bool near = delta && !std::holds_alternative<DirectionalLight>(light.shape);
    if (near || options.bounces > 0) { key.add(scene.length_unit_m); }
    if (!delta || options.bounces > 0) {
        key.add(options.samples, options.seed, number);
        add_target(key, scene, light);
    }
    if (std::holds_alternative<MeshLight>(light.shape)) {
        const bool textured =
            std::find(scene.textured.begin(), scene.textured.end(), true) != scene.textured.end();
        if (textured) { add_materials(key, scene); }
        for (const Material& material : scene.materials) { key.add(emission(material)); }
        key.add(scene.material_of_group);
    }
}

}  // namespace

std::string column_key(Told told, const Scene& scene, std::size_t light, bool sh,
                       const FileNames& names)
{
    KeyText key(names);
    key.add(told);
    switch (told) {
        case Told::E:
            add_light(key, scene, light);
            if (scene.transport.bounces > 0) { add_materials(key, scene); }
            break;
        case Told::Lo:
            add_light(key, scene, light);
            add_materials(key, scene);
            key.add(scene.view);
            if (std::holds_alternative<CameraView>(scene.view)) { key.add(scene.camera.eye); }
            break;
        case Told::Sky:
            key.add(sh, scene.transport.samples, scene.transport.seed,
                    scene.transport.max_distance);
            break;
    }
    return sha256(key.text());
}

}  // namespace relight
