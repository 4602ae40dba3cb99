#include <algorithm>
#include <cmath>

#include "core/io/fields_writer.h"
#include "server/answer_parts.h"
#include "server/derived.h"
#include "server/json_text.h"

namespace relight {
namespace {

/// The arrays that ?fields= asks for, in its order; their spans are of `derived`.
std::vector<Field> fields_of(const Derived& derived, const std::vector<FieldWanted>& wanted)
{
    const Lit& lit = *derived.lit;
    const UnitNames units = unit_names(lit.scene.units);
    const auto& lights = lit.scene.lights;
    std::vector<Field> fields;
    const auto add = [&](const std::string& name, FieldType type, int components,
                         std::span<const float> values, std::string_view unit) {
        fields.push_back({name, type, components, values, std::string(unit)});
    };
    for (const auto& [name, type] : wanted) {
        if (name == "color") {
            fields.push_back({name, type, 3, std::span<const Rgb8>(derived.color), "sRGB 8-bit"});
        } else if (name == "irradiance") {
            add(name, type, 3, floats(lit.shaded.irradiance), units.irradiance);
        } else if (name == "radiance") {
            add(name, type, 3, floats(lit.shaded.radiance), units.radiance);
        } else if (name == "standard_error") {
            add(name, type, 3, floats(lit.shaded.standard_error), units.irradiance);
        } else if (name == "normal") {
            add(name, type, 3, derived.normals, "1");
        } else if (name == "ambient_occlusion") {
            add(name, type, 1, lit.transport.sky->ambient_occlusion, "1");
        } else if (name == "sh") {
            add(name, type, static_cast<int>(sh_coefficients), lit.transport.sky->sh, "sr");
        } else if (name == "visibility") {
            for (std::size_t l = 0; l < lights.size(); ++l) {
                if (derived.visible[l].empty()) { continue; }
                add("visibility/" + lights[l].name, type, 1, derived.visible[l], "1");
            }
        } else {
            for (std::size_t l = 0; l < lights.size(); ++l) {
                add("per_light/" + lights[l].name, type, 3, floats(lit.shaded.per_light[l]),
                    units.irradiance);
            }
        }
    }
    return fields;
}

/// How far off the irradiances are, as the head of a message tells it.
std::string error_json(std::span<const Rgbf> errors)
{
    double squares = 0.0;
    float largest = 0.0F;
    for (const Rgbf& error : errors) {
        const float band = std::max({error[0], error[1], error[2]});
        largest = std::max(largest, band);
        squares += static_cast<double>(band) * static_cast<double>(band);
    }
    const double count = static_cast<double>(std::max<std::size_t>(1, errors.size()));
    return ObjectWriter()
        .number("root_mean_square", std::sqrt(squares / count))
        .number("largest", static_cast<double>(largest))
        .done();
}

}  // namespace

Encoding fields_answer(const Derived& derived, const Output& output, bool last)
{
    const Lit& lit = *derived.lit;
    ObjectWriter more;
    if (!derived.color.empty()) { more.raw("display", display_json(derived.display)); }
    more.raw("view", view_json(lit.scene)).count("samples", lit.scene.transport.samples);
    if (!lit.shaded.standard_error.empty()) {
        more.raw("standard_error", error_json(lit.shaded.standard_error));
    }
    if (output.progressive) { more.count("rays", lit.transport.rays).flag("final", last); }
    more.raw("warnings", text_array(lit.warnings));
    const std::string members = more.done();
    return encode_fields(lit.stage.mesh->positions.size(), fields_of(derived, output.fields),
                         std::string_view(members).substr(1, members.size() - 2));
}

}  // namespace relight
