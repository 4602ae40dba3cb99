#include "server/light_json.h"

namespace relight {
namespace {

/// "albedo": [r,g,b] or "vertex".
void parse_albedo(Fields& fields, Rgb& albedo, bool& from_vertex)
{
    const Json* json = fields.find("albedo");
    if (json != nullptr && std::holds_alternative<std::string>(json->value)) {
        from_vertex = fields.choice("albedo", {"vertex"}).has_value();
        return;
    }
    albedo = fields.color("albedo", {0.0, 1.0, {}}).value_or(albedo);
}

/// "f0" [r,g,b] or "ior" or "eta" with "k" [r,g,b]; f0 0.04 if none is given.
FresnelModel parse_fresnel(Fields& fields)
{
    constexpr Range index_range{1e-3, 100.0, {}};
    const auto F0 = fields.color("f0", {0.0, 1.0, {}});
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
    parse_albedo(fields, lambert.albedo, lambert.albedo_from_vertex);
    return lambert;
}

Material parse_cook_torrance(Fields& fields)
{
    CookTorrance material;
    parse_albedo(fields, material.albedo, material.albedo_from_vertex);
    material.fresnel = parse_fresnel(fields);
    const double roughness = fields.number("roughness", {0.0, 1.0, {}}).value_or(0.5);
    material.alpha_x = material.alpha_y = alpha_from_roughness(roughness);
    const auto distribution = fields.choice("distribution", {"beckmann", "ggx", "gtr"});
    if (distribution == "beckmann") { material.distribution = Distribution::Beckmann; }
    if (distribution == "gtr") {
        material.distribution = Distribution::Gtr;
        material.gamma = fields.number("gamma", {0.1, 10.0, {}}).value_or(2.0);
    }
    if (fields.flag("multiscatter").value_or(false)) {
        fields.fail(Fault::NotAvailable, "multiscatter",
                    "energy compensation is not in this build; false is");
    }
    return material;
}

}  // namespace

Material parse_material(Fields fields)
{
    const auto model = fields.choice("model", {"lambert", "cook_torrance"},
                                     {"oren_nayar", "principled", "metallic_roughness"});
    if (!model) {  // which other fields there are depends on it
        if (!fields.has("model")) {
            fields.fail(Fault::MissingField, "model",
                        "a material needs \"model\": lambert or cook_torrance");
        }
        return Lambert{};
    }
    Material material = *model == "lambert" ? parse_lambert(fields) : parse_cook_torrance(fields);
    fields.finish();
    if (auto* facets = std::get_if<CookTorrance>(&material);
        facets != nullptr && !fields.errors()) {
        return make_cook_torrance(std::move(*facets));
    }
    return material;
}

}  // namespace relight
