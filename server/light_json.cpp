#include "server/light_json.h"

#include <algorithm>
#include <numbers>
#include <span>

#include "core/light/temperature.h"
#include "server/json_text.h"
#include "server/light_shape_json.h"

namespace relight {
namespace {

constexpr double largest_power = 1e12;  // keeps E finite in single precision down to a micrometre
/// Of a flux over a small area: times the greatest color and efficacy, pi L is still a float.
constexpr double largest_radiance = 1e24;
constexpr std::size_t longest_name = 64;
constexpr std::size_t most_skies = 24;  // a day's hours; each is a table of megabytes

std::string names_of(std::span<const PowerField> allowed)
{
    std::string names;
    for (const PowerField& field : allowed) {
        names.append(names.empty() ? "" : ", ").append(field.name);
    }
    return names;
}

struct Power {
    double value{};
    const PowerField* field = nullptr;
};

/// Exactly one of the allowed fields.
Power parse_power(Fields& fields, std::span<const PowerField> allowed)
{
    Power power;
    for (const PowerField& field : allowed) {
        const auto value = fields.number(field.name, {0.0, largest_power, field.unit});
        if (!fields.has(field.name)) { continue; }
        if (power.field != nullptr) {
            fields.fail(Fault::ConflictingFields, field.name,
                        "\"" + std::string(power.field->name) +
                            "\" is given too; exactly one of: " + names_of(allowed));
        }
        power = {value.value_or(0.0), &field};
    }
    return power;
}

/// Surface that shines [scene units squared]: of both sides, if both do.
double emitting_area(const LightShape& shape)
{
    if (const auto* rect = std::get_if<RectLight>(&shape)) {
        return area(*rect) * (rect->two_sided ? 2.0 : 1.0);
    }
    if (const auto* disk = std::get_if<DiskLight>(&shape)) { return area(*disk); }
    if (const auto* sphere = std::get_if<SphereLight>(&shape)) { return area(*sphere); }
    return 0.0;
}

/// The shape's power of one unit of flux: I of a point or spot; L = Phi / (pi A) of a Lambertian
/// emitter.   Contract section 1
double power_of_flux(const LightShape& shape, double length_unit_m)
{
    const RadiantFlux one{Rgb::grey(1.0)};
    if (const auto* point = std::get_if<PointLight>(&shape)) {
        return intensity_of_flux(*point, one).value.r;
    }
    if (const auto* spot = std::get_if<SpotLight>(&shape)) {
        return intensity_of_flux(*spot, one).value.r;
    }
    return 1.0 / (std::numbers::pi * emitting_area(shape) * length_unit_m * length_unit_m);
}

/// `power` as what the shape counts in.
double unit_power(const LightShape& shape, const Power& power, double length_unit_m, Fields& fields)
{
    if (power.field == nullptr || !power.field->is_flux || fields.errors()) { return power.value; }
    const double value = power.value * power_of_flux(shape, length_unit_m);
    if (!(value <= largest_radiance)) {  // also infinite, and 0 W over no area
        fields.fail(Fault::OutOfRange, power.field->name,
                    "found " + decimal(power.value) + " " + std::string(power.field->unit) +
                        " over an area of " +
                        decimal(emitting_area(shape) * length_unit_m * length_unit_m) +
                        " m2: its radiance has no bound. Give the light an area, or its radiance "
                        "instead of a flux, or make it a point light");
        return 0.0;
    }
    return value;
}

bool is_name(std::string_view name)
{
    return std::none_of(name.begin(), name.end(),
                        [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
}

/// "color" or "temperature_k"; white if none is given.
Rgb parse_color(Fields& fields)
{
    const auto color = fields.color("color", {0.0, 1e6, {}});
    const auto kelvin =
        fields.number("temperature_k", {least_temperature_k, largest_temperature_k, "K"});
    if (fields.has("color") && fields.has("temperature_k")) {
        fields.fail(Fault::ConflictingFields, "temperature_k",
                    "\"color\" is given too; a light has one or the other");
    }
    return kelvin ? blackbody(*kelvin) : color.value_or(Rgb::grey(1.0));
}

struct ParsedLight {
    Light light;
    const PowerField* unit = nullptr;  // null: it has none of its own
    std::optional<LightFile> file;
    std::optional<ClearSky> sky;
};

ParsedLight parse_light(const Json& json, const std::string& pointer, double length_unit_m,
                        FirstError& errors)
{
    Fields fields(json, pointer, "a light", errors);
    const auto type = fields.choice("type", {"point", "spot", "directional", "rect", "disk",
                                             "sphere", "ies", "environment", "sky", "from_mesh"});
    if (!type) {  // which other fields there are depends on it
        if (!fields.has("type")) {
            fields.fail(Fault::MissingField, "type",
                        "a light needs \"type\": point, spot, directional, rect, disk, sphere, "
                        "ies, environment, sky or from_mesh");
        }
        return {};
    }
    Fields own(json, pointer, "a light of type \"" + *type + "\"", errors);
    own.find("type");
    ParsedShape parsed = parse_shape(*type, own);
    const Power power = parse_power(own, parsed.powers);
    ParsedLight result;
    Light& light = result.light;
    light.name = own.text("name", longest_name).value_or("");
    if (!is_name(light.name)) {
        own.fail(Fault::UnknownValue, "name",
                 "found a control character; a name is printable text");
    }
    const Rgb color = parse_color(own);
    light.enabled = own.flag("enabled").value_or(true);
    light.cast_shadows = own.flag("cast_shadows").value_or(true);
    own.finish();
    if (!parsed.powers.empty() && power.field == nullptr) {
        errors.report(make_error(Fault::MissingField,
                                 "a light of type \"" + *type +
                                     "\" needs exactly one of: " + names_of(parsed.powers) +
                                     (*type == "environment" ? "; or an image" : ""),
                                 pointer));
        return result;
    }
    light.power =
        color * (parsed.powers.empty() ? parsed.scale
                                       : unit_power(parsed.shape, power, length_unit_m, own));
    light.shape = std::move(parsed.shape);
    result.unit = parsed.powers.empty() ? parsed.implied : power.field;
    result.sky = parsed.sky;
    if (parsed.file) {
        result.file = {0, std::move(*parsed.file), own.pointer_to(parsed.file_field)};
    }
    return result;
}

/// The file's own lights stand once.
void refuse_second_mesh_light(const std::vector<Light>& lights, FirstError& errors)
{
    std::optional<std::size_t> from_mesh;
    for (std::size_t i = 0; i < lights.size(); ++i) {
        if (!std::holds_alternative<MeshLight>(lights[i].shape)) { continue; }
        if (from_mesh) {
            errors.report(
                make_error(Fault::ConflictingFields,
                           "light " + std::to_string(*from_mesh) +
                               " is \"from_mesh\" too; the file's own lights are asked for once",
                           "/lights" + pointer_step(i) + "/type"));
        }
        from_mesh = i;
    }
}

/// Names tell lights apart in the answer: given ones are unique, others are light_<place>.
void name_lights(std::vector<Light>& lights, FirstError& errors)
{
    for (std::size_t i = 0; i < lights.size(); ++i) {
        if (lights[i].name.empty()) { lights[i].name = "light_" + std::to_string(i); }
    }
    for (std::size_t i = 0; i < lights.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            if (lights[i].name != lights[j].name) { continue; }
            errors.report(make_error(Fault::ConflictingFields,
                                     "light " + std::to_string(j) + " is called \"" +
                                         printable(lights[i].name) +
                                         "\" too; names tell lights apart in the answer",
                                     "/lights/" + std::to_string(i) + "/name"));
        }
    }
}

/// What a light with a unit of its own brings into the request.
std::string described(const PowerField& field)
{
    return "\"" + std::string(field.name) + "\" (" + std::string(field.unit) + ")";
}

}  // namespace

ParsedLights parse_lights(const JsonArray& lights, std::optional<double> efficacy,
                          double length_unit_m, FirstError& errors)
{
    ParsedLights parsed;
    const PowerField* first = nullptr;  // that set the units
    bool from_mesh = false;             // glTF's: photometric unless another light says otherwise
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const std::string pointer = "/lights" + pointer_step(i);
        ParsedLight light = parse_light(lights[i], pointer, length_unit_m, errors);
        const PowerField* unit = light.unit;
        if (unit != nullptr && efficacy && unit->units == Units::Radiometric) {
            light.light.power = light.light.power * *efficacy;
        } else if (unit != nullptr && !efficacy) {
            if (first == nullptr) { first = unit; }
            if (unit->units != first->units) {
                errors.report(make_error(Fault::MixedUnits,
                                         described(*unit) + " beside " + described(*first) +
                                             ": a request is wholly in watts or wholly in lumens; "
                                             "\"luminous_efficacy_lm_w\" converts the watts",
                                         pointer + "/" + std::string(unit->name)));
            }
        }
        if (light.sky) {
            light.sky->light = i;
            parsed.skies.push_back(*light.sky);
            if (parsed.skies.size() > most_skies) {
                errors.report(make_error(Fault::OutOfRange,
                                         "found one sky more; at most " +
                                             std::to_string(most_skies) +
                                             " of a request's lights are skies",
                                         pointer + "/type"));
            }
        }
        from_mesh = from_mesh || std::holds_alternative<MeshLight>(light.light.shape);
        if (light.file) {
            light.file->light = i;
            parsed.files.push_back(std::move(*light.file));
        }
        parsed.lights.push_back(std::move(light.light));
    }
    if (efficacy || (first == nullptr && from_mesh)) {
        parsed.units = Units::Photometric;
    } else if (first != nullptr) {
        parsed.units = first->units;
    }
    refuse_second_mesh_light(parsed.lights, errors);
    name_lights(parsed.lights, errors);
    return parsed;
}

}  // namespace relight
