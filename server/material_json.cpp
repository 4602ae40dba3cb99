#include <numbers>
#include <span>

#include "server/json_text.h"
#include "server/light_json.h"

namespace relight {
namespace {

constexpr double degree = std::numbers::pi / 180.0;
constexpr Range share{0.0, 1.0, {}};

/// A field of a material that is a number, and the member that it sets.
template <class M>
struct Scalar {
    std::string_view name;
    double M::*value;
    Range range = share;
};
template <class M>
void parse_scalars(Fields& fields, M& material, std::span<const Scalar<M>> scalars)
{
    for (const Scalar<M>& scalar : scalars) {
        double& value = material.*scalar.value;
        value = fields.number(scalar.name, scalar.range).value_or(value);
    }
}

/// [r,g,b] or "vertex".
void parse_albedo(Fields& fields, std::string_view name, Rgb& albedo, bool& from_vertex)
{
    const Json* json = fields.find(name);
    if (json != nullptr && std::holds_alternative<std::string>(json->value)) {
        from_vertex = fields.choice(name, {"vertex"}).has_value();
        return;
    }
    albedo = fields.color(name, share).value_or(albedo);
}

/// "f0" [r,g,b] or "ior" or "eta" with "k" [r,g,b]; f0 0.04 if none is given.
FresnelModel parse_fresnel(Fields& fields)
{
    constexpr Range index_range{1e-3, 100.0, {}};
    const auto F0 = fields.color("f0", share);
    const auto ior = fields.number("ior", {1.0, 10.0, {}});
    const auto eta = fields.color("eta", index_range);
    const auto k = fields.color("k", {0.0, 100.0, {}});
    const bool conductor = fields.has("eta") || fields.has("k");
    if (conductor) { fields.need({"eta", "k"}); }
    for (const std::string_view other : {"ior", "eta", "k"}) {
        const bool first = fields.has("f0") || (other != "ior" && fields.has("ior"));
        if (first && fields.has(other)) {
            fields.fail(Fault::ConflictingFields, other,
                        "exactly one of: f0; ior; eta with k, says how the surface reflects");
        }
    }
    if (conductor) { return ConductorEtaK{eta.value_or(Rgb::grey(1.0)), k.value_or(Rgb{})}; }
    if (ior) { return DielectricIor{*ior}; }
    return F0 ? SchlickF0{*F0} : SchlickF0{};
}

Material parse_lambert(Fields& fields)
{
    Lambert lambert;
    parse_albedo(fields, "albedo", lambert.albedo, lambert.albedo_from_vertex);
    return lambert;
}

Material parse_oren_nayar(Fields& fields)
{
    OrenNayar material;
    parse_albedo(fields, "albedo", material.albedo, material.albedo_from_vertex);
    material.sigma = fields.number("sigma_deg", {0, 90, "degrees"}).value_or(0.0) * degree;
    return material;
}

Material parse_cook_torrance(Fields& fields)
{
    CookTorrance material;
    parse_albedo(fields, "albedo", material.albedo, material.albedo_from_vertex);
    material.fresnel = parse_fresnel(fields);
    const double roughness = fields.number("roughness", share).value_or(0.5);
    material.alpha_x = material.alpha_y = alpha_from_roughness(roughness);
    const auto distribution = fields.choice("distribution", {"beckmann", "ggx", "gtr"});
    if (distribution == "beckmann") { material.distribution = Distribution::Beckmann; }
    if (distribution == "gtr") {
        material.distribution = Distribution::Gtr;
        material.gamma = fields.number("gamma", {0.1, 10.0, {}}).value_or(2.0);
    }
    material.multiscatter = fields.flag("multiscatter").value_or(false);
    return material;
}

Material parse_principled(Fields& fields)
{
    constexpr Scalar<Principled> scalars[] = {{"metallic", &Principled::metallic},
                                              {"subsurface", &Principled::subsurface},
                                              {"specular", &Principled::specular},
                                              {"roughness", &Principled::roughness},
                                              {"specular_tint", &Principled::specular_tint},
                                              {"anisotropic", &Principled::anisotropic},
                                              {"sheen", &Principled::sheen},
                                              {"sheen_tint", &Principled::sheen_tint},
                                              {"clearcoat", &Principled::clearcoat},
                                              {"clearcoat_gloss", &Principled::clearcoat_gloss}};
    Principled material;
    parse_albedo(fields, "base_color", material.base_color, material.base_color_from_vertex);
    parse_scalars<Principled>(fields, material, scalars);
    return material;
}

Material parse_metallic_roughness(Fields& fields)
{
    using M = MetallicRoughness;
    constexpr double brightest = 1e12;  // that a light may be, too
    constexpr Scalar<M> scalars[] = {
        {"metallic", &M::metallic},
        {"roughness", &M::roughness},
        {"specular", &M::specular},
        {"clearcoat", &M::clearcoat},
        {"clearcoat_roughness", &M::clearcoat_roughness},
        {"sheen_roughness", &M::sheen_roughness},
        {"anisotropy_strength", &M::anisotropy_strength},
        {"anisotropy_rotation_deg", &M::anisotropy_rotation, {-360, 360, "degrees"}},
        {"emissive_strength", &M::emissive_strength, {0, brightest, "cd/m2 or W/(m2 sr)"}},
        {"ior", &M::ior, {0, 10, {}}}};
    M material;
    parse_albedo(fields, "base_color", material.base_color, material.base_color_from_vertex);
    parse_scalars<M>(fields, material, scalars);
    material.anisotropy_rotation *= degree;
    if (material.ior > 0.0 && material.ior < 1.0) {
        fields.fail(
            Fault::OutOfRange, "ior",
            "found " + decimal(material.ior) +
                "; allowed: 1..10, or 0 for a surface that reflects all (KHR_materials_ior)");
    }
    // F0 is this times ((ior - 1) / (ior + 1))^2, and cut at 1.
    constexpr Range specular_range{0.0, 1e3, {}};
    material.specular_color =
        fields.color("specular_color", specular_range).value_or(material.specular_color);
    material.sheen_color = fields.color("sheen_color", share).value_or(material.sheen_color);
    material.emissive = fields.color("emissive", share).value_or(material.emissive);
    return material;
}

}  // namespace

Material parse_material(Fields fields)
{
    constexpr std::pair<std::string_view, Material (*)(Fields&)> models[] = {
        {"lambert", parse_lambert},
        {"oren_nayar", parse_oren_nayar},
        {"cook_torrance", parse_cook_torrance},
        {"principled", parse_principled},
        {"metallic_roughness", parse_metallic_roughness}};
    const auto model = fields.choice(
        "model", {"lambert", "oren_nayar", "cook_torrance", "principled", "metallic_roughness"});
    if (!model) {  // which other fields there are depends on it
        if (!fields.has("model")) {
            fields.fail(Fault::MissingField, "model",
                        "a material needs \"model\": lambert, oren_nayar, cook_torrance, "
                        "principled or metallic_roughness");
        }
        return Lambert{};
    }
    Material material;
    for (const auto& [name, parse] : models) {
        if (name == *model) { material = parse(fields); }
    }
    fields.finish();
    return material;
}

std::vector<GroupMaterial> parse_materials(const Json& json, const std::string& pointer,
                                           FirstError& errors)
{
    const auto* entries = std::get_if<JsonObject>(&json.value);
    if (entries == nullptr) {
        errors.report(make_error(
            Fault::WrongType,
            "found " + description_of(json) + R"(; materials is an object {"name or index": {…}})",
            pointer));
        return {};
    }
    std::vector<GroupMaterial> materials;
    for (const JsonMember& entry : *entries) {
        Fields fields(entry.value, pointer + pointer_step(entry.name), "a material", errors);
        materials.push_back({entry.name, parse_material(std::move(fields))});
    }
    return materials;
}

}  // namespace relight
