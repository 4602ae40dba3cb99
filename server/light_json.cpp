#include "server/light_json.h"

#include <algorithm>
#include <numbers>
#include <span>

#include "server/json_text.h"

namespace relight {
namespace {

constexpr double largest_power = 1e12;  // keeps E finite in single precision down to a micrometre
constexpr double degree = std::numbers::pi / 180.0;
constexpr std::size_t longest_name = 64;

/// One of the fields that say how strong a light is.
struct PowerField {
    std::string_view name, unit;
    Units units;
    bool is_flux;
};
constexpr PowerField point_powers[] = {{"flux_w", "W", Units::Radiometric, true},
                                       {"flux_lm", "lm", Units::Photometric, true},
                                       {"intensity_w_sr", "W/sr", Units::Radiometric, false},
                                       {"intensity_cd", "cd", Units::Photometric, false}};
constexpr PowerField directional_powers[] = {{"irradiance_w_m2", "W/m2", Units::Radiometric, false},
                                             {"illuminance_lx", "lx", Units::Photometric, false}};

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

bool is_name(std::string_view name)
{
    return std::none_of(name.begin(), name.end(),
                        [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7F; });
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

struct ParsedLight {
    Light light;
    Power power;
};

PointLight parse_point(Fields& fields)
{
    fields.need({"position"});
    return {fields.point("position").value_or(Point3{}), {}};
}

SpotLight parse_spot(Fields& fields)
{
    fields.need({"position", "direction"});
    SpotLight spot;
    spot.position = fields.point("position").value_or(Point3{});
    spot.axis = fields.direction("direction").value_or(Dir3{});
    const double outer = fields.number("outer_cone_deg", {0, 90, "degrees", true}).value_or(45.0);
    const double inner = fields.number("inner_cone_deg", {0, 90, "degrees"}).value_or(0.0);
    if (inner > outer) {
        fields.fail(Fault::OutOfRange, "inner_cone_deg",
                    "found " + decimal(inner) + "; at most outer_cone_deg, which is " +
                        decimal(outer) + " degrees");
    }
    spot.inner_cone = inner * degree;
    spot.outer_cone = outer * degree;
    return spot;
}

DirectionalLight parse_directional(Fields& fields)
{
    fields.need({"direction"});
    if (fields.number("angle_deg", {0, 90, "degrees"}).value_or(0.0) != 0.0) {
        fields.fail(Fault::NotAvailable, "angle_deg",
                    "suns with an angular size are not in this build; 0 (a hard shadow) is");
    }
    return {fields.direction("direction").value_or(Dir3{})};
}

ParsedLight parse_light(const Json& json, const std::string& pointer, FirstError& errors)
{
    Fields fields(json, pointer, "a light", errors);
    const auto type =
        fields.choice("type", {"point", "spot", "directional"},
                      {"rect", "disk", "sphere", "ies", "environment", "sky", "from_mesh"});
    ParsedLight parsed;
    if (!type) {  // which other fields there are depends on it
        if (!fields.has("type")) {
            fields.fail(Fault::MissingField, "type",
                        "a light needs \"type\": point, spot or directional");
        }
        return parsed;
    }
    Fields own(json, pointer, "a " + *type + " light", errors);
    own.find("type");
    const std::span<const PowerField> allowed =
        *type == "directional" ? std::span<const PowerField>(directional_powers)
                               : std::span<const PowerField>(point_powers);
    if (*type == "point") {
        parsed.light.shape = parse_point(own);
    } else if (*type == "spot") {
        parsed.light.shape = parse_spot(own);
    } else {
        parsed.light.shape = parse_directional(own);
    }
    parsed.power = parse_power(own, allowed);
    parsed.light.name = own.text("name", longest_name).value_or("");
    if (!is_name(parsed.light.name)) {
        own.fail(Fault::UnknownValue, "name",
                 "found a control character; a name is printable text");
    }
    own.not_yet({"temperature_k"}, "it has \"color\": [r,g,b]");
    const Rgb color = own.color("color", {0.0, 1e6, {}}).value_or(Rgb::grey(1.0));
    parsed.light.enabled = own.flag("enabled").value_or(true);
    parsed.light.cast_shadows = own.flag("cast_shadows").value_or(true);
    own.finish();
    if (parsed.power.field == nullptr) {
        errors.report(make_error(Fault::MissingField,
                                 "a " + *type + " light needs exactly one of: " + names_of(allowed),
                                 pointer));
        return parsed;
    }
    RadiantFlux given{color * parsed.power.value};
    if (parsed.power.field->is_flux) {
        if (const auto* point = std::get_if<PointLight>(&parsed.light.shape)) {
            given.value = intensity_of_flux(*point, given).value;
        } else if (const auto* spot = std::get_if<SpotLight>(&parsed.light.shape)) {
            given.value = intensity_of_flux(*spot, given).value;
        }
    }
    parsed.light.power = given.value;
    return parsed;
}

}  // namespace

ParsedLights parse_lights(const JsonArray& lights, std::optional<double> efficacy,
                          FirstError& errors)
{
    ParsedLights parsed;
    if (efficacy) { parsed.units = Units::Photometric; }
    const PowerField* first = nullptr;  // that set the units
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const std::string pointer = "/lights" + pointer_step(i);
        ParsedLight light = parse_light(lights[i], pointer, errors);
        const PowerField* field = light.power.field;
        if (field != nullptr && efficacy && field->units == Units::Radiometric) {
            light.light.power = light.light.power * *efficacy;
        } else if (field != nullptr && !efficacy) {
            if (first == nullptr) { first = field; }
            if (field->units != first->units) {
                errors.report(make_error(
                    Fault::MixedUnits,
                    "\"" + std::string(field->name) + "\" beside \"" + std::string(first->name) +
                        "\": a request is wholly in watts or wholly in lumens; "
                        "\"luminous_efficacy_lm_w\" converts the watts",
                    pointer + "/" + std::string(field->name)));
            }
            parsed.units = first->units;
        }
        parsed.lights.push_back(std::move(light.light));
    }
    name_lights(parsed.lights, errors);
    return parsed;
}

}  // namespace relight
