#include "server/output_json.h"

#include <algorithm>

#include "server/json_text.h"
#include "server/json_tree.h"

namespace relight {
namespace {

constexpr int largest_image = 8192;  // pixels, each way

constexpr std::pair<std::string_view, bool Quantities::*> quantities[] = {
    {"color", &Quantities::color},
    {"irradiance", &Quantities::irradiance},
    {"radiance", &Quantities::radiance},
    {"ambient_occlusion", &Quantities::ambient_occlusion},
    {"visibility", &Quantities::visibility},
    {"normal", &Quantities::normal},
    {"standard_error", &Quantities::standard_error},
    {"per_light", &Quantities::per_light},
    {"sh", &Quantities::sh}};

constexpr std::pair<std::string_view, Format> formats[] = {
    {"ply", Format::Ply},   {"ply_ascii", Format::PlyAscii},
    {"obj", Format::Obj},   {"off", Format::Off},
    {"glb", Format::Glb},   {"vtp", Format::Vtp},
    {"las", Format::Las},   {"json", Format::Json},
    {"npz", Format::Npz},   {"png", Format::Png},
    {"jpeg", Format::Jpeg}, {"exr", Format::Exr},
    {"hdr", Format::Hdr}};

Quantities parse_quantities(Fields& output)
{
    const JsonArray* names = output.array("quantities");
    Quantities wanted;
    if (names == nullptr) {
        wanted.color = true;
        return wanted;
    }
    if (names->empty()) {
        output.fail(Fault::WrongLength, "quantities",
                    "found no quantities; at least 1, as \"color\"");
    }
    for (std::size_t i = 0; i < names->size(); ++i) {
        // An array's item read as a field, so that a word is checked in one place.
        const std::string place = std::to_string(i);
        const Json item{JsonObject{{place, (*names)[i]}}};
        Fields one(item, output.pointer_to("quantities"), "a quantity", output.errors());
        const auto name =
            one.choice(place, {"color", "irradiance", "radiance", "ambient_occlusion", "visibility",
                               "normal", "standard_error", "per_light", "sh"});
        if (!name) { continue; }
        const auto entry = std::find_if(std::begin(quantities), std::end(quantities),
                                        [&](const auto& q) { return q.first == *name; });
        bool& asked = wanted.*entry->second;
        if (asked) {
            one.fail(Fault::ConflictingFields, place, "\"" + *name + "\" is asked for twice");
        }
        asked = true;
    }
    return wanted;
}

}  // namespace

Display parse_display(Fields fields)
{
    Display display;
    const Json* exposure = fields.find("exposure_ev");
    if (exposure != nullptr && std::holds_alternative<std::string>(exposure->value)) {
        display.auto_exposure = fields.choice("exposure_ev", {"auto"}).has_value();
    } else {
        display.exposure_ev =
            fields.number("exposure_ev", {-64.0, 64.0, "EV (stops)"}).value_or(0.0);
    }
    const auto map = fields.choice(
        "tone_map",
        {"none", "reinhard", "reinhard_extended", "aces_narkowicz", "aces_hill", "pbr_neutral"},
        {"agx"});
    if (map == "reinhard") { display.tone_map = ToneMap::Reinhard; }
    if (map == "reinhard_extended") { display.tone_map = ToneMap::ReinhardExtended; }
    if (map == "aces_narkowicz") { display.tone_map = ToneMap::AcesNarkowicz; }
    if (map == "aces_hill") { display.tone_map = ToneMap::AcesHill; }
    if (map == "pbr_neutral") { display.tone_map = ToneMap::PbrNeutral; }
    if (display.tone_map == ToneMap::ReinhardExtended) {
        display.white = fields.number("white", {0.0, 1e12, "luminance after exposure", true})
                            .value_or(display.white);
    }
    fields.choice("transfer", {"srgb"});
    fields.finish();
    return display;
}

Output parse_output(Fields fields, const ParseLimits& limits)
{
    Output output;
    const auto format =
        fields.choice("format", {"ply", "ply_ascii", "obj", "off", "glb", "vtp", "las", "json",
                                 "npz", "png", "jpeg", "exr", "hdr"});
    for (const auto& [name, value] : formats) {
        if (format == name) { output.format = value; }
    }
    output.names_quantities = fields.has("quantities");
    output.quantities = parse_quantities(fields);
    for (const std::string_view name : {"width", "height", "samples", "renderer", "background"}) {
        if (fields.has(name) && !output.image_field) { output.image_field = name; }
    }
    output.width =
        static_cast<int>(fields.integer("width", 1, largest_image).value_or(output.width));
    output.height =
        static_cast<int>(fields.integer("height", 1, largest_image).value_or(output.height));
    output.samples = static_cast<int>(fields.integer("samples", 1, 1024).value_or(output.samples));
    if (fields.choice("renderer", {"raytrace", "vtk"}) == "vtk") {
        output.renderer = Renderer::Vtk;
    }
    if (fields.has("quality")) {
        output.quality = static_cast<int>(fields.integer("quality", 1, 100).value_or(92));
        if (output.format != Format::Jpeg) {
            fields.fail(Fault::ConflictingFields, "quality",
                        "only a jpeg has it: add \"format\": \"jpeg\"");
        }
    }
    const Json* background = fields.find("background");
    if (background != nullptr && std::holds_alternative<std::string>(background->value)) {
        output.transparent = fields.choice("background", {"transparent"}).has_value();
    } else {
        output.background = fields.color("background", {0.0, 1e12, "radiance"});
    }
    const auto pixels =
        static_cast<std::uint64_t>(output.width) * static_cast<std::uint64_t>(output.height);
    if (pixels > limits.pixels) {
        fields.fail(Fault::OutOfRange, "height",
                    "found " + std::to_string(pixels) + " pixels; at most " +
                        std::to_string(limits.pixels) + " (limit --max-pixels)");
    }
    fields.finish();
    return output;
}

namespace {

/// Why an array of this quantity cannot have this type; empty if it can.
std::string_view misfit(std::string_view quantity, FieldType type)
{
    const bool share = quantity == "visibility" || quantity == "ambient_occlusion";
    if (quantity == "color" && type != FieldType::UInt8) {
        return "color is sRGB codes, uint8; radiance is what it is made of";
    }
    if (quantity != "color" && !share && type == FieldType::UInt8) {
        return "uint8 is for color, and for visibility and ambient_occlusion, which are shares";
    }
    return {};
}

}  // namespace

std::optional<Error> parse_fields_query(std::string_view text, Output& output)
{
    if (output.format || output.names_quantities) {
        return make_error(
            Fault::ConflictingFields,
            "?fields= says what comes and how; leave \"format\" and \"quantities\" out",
            output.format ? "/output/format" : "/output/quantities");
    }
    output.format = Format::Fields;
    output.quantities = {};
    while (true) {
        const std::string_view one = text.substr(0, text.find(','));
        const auto colon = one.find(':');
        const std::string_view name = one.substr(0, colon);
        const auto* entry = std::find_if(std::begin(quantities), std::end(quantities),
                                         [&](const auto& q) { return q.first == name; });
        if (entry == std::end(quantities)) {
            return make_error(Fault::UnknownValue,
                              "found \"" + printable(name) +
                                  "\" in ?fields=; allowed: color, irradiance, radiance, "
                                  "ambient_occlusion, visibility, normal, standard_error, "
                                  "per_light, sh, each with :float32, :float16 or :uint8");
        }
        const auto type = colon == std::string_view::npos
                              ? name == "color" ? FieldType::UInt8 : FieldType::Float32
                              : field_type(one.substr(colon + 1));
        if (!type) {
            return make_error(Fault::UnknownValue, "found \"" + printable(one.substr(colon + 1)) +
                                                       "\" as a type in ?fields=; allowed: "
                                                       "float32, float16, uint8");
        }
        if (const auto why = misfit(name, *type); !why.empty()) {
            return make_error(Fault::UnknownValue,
                              "found \"" + printable(one) + "\" in ?fields=; " + std::string(why));
        }
        bool& asked = output.quantities.*entry->second;
        if (asked) {
            return make_error(Fault::DuplicateField,
                              std::string(name) + " stands twice in ?fields=");
        }
        asked = true;
        output.fields.push_back({std::string(name), *type});
        if (one.size() == text.size()) { return {}; }
        text.remove_prefix(one.size() + 1);
    }
}

}  // namespace relight
