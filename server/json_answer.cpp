#include <array>

#include "core/io/writers.h"
#include "server/answer_parts.h"
#include "server/derived.h"
#include "server/json_text.h"

namespace relight {
namespace {

/// Writes an object member after member; what comes behind each name is the caller's.
class Members {
  public:
    explicit Members(BlockOut& out) : out_(out) {}

    void name(std::string_view name)
    {
        out_.bytes(first_ ? "{" : ",");
        out_.bytes(json_string(name));
        out_.bytes(":");
        first_ = false;
    }
    void raw(std::string_view name_of, std::string_view json)
    {
        name(name_of);
        out_.bytes(json);
    }
    void array(std::string_view name_of, std::span<const float> values, std::size_t components)
    {
        name(name_of);
        write_json(out_, values, static_cast<int>(components));
    }
    void done() { out_.bytes(first_ ? "{}" : "}"); }

  private:
    BlockOut& out_;
    bool first_ = true;
};

void write_colors(BlockOut& out, std::span<const Rgb8> colors)
{
    std::array<std::string, 256> codes;
    for (std::size_t code = 0; code < codes.size(); ++code) { codes[code] = std::to_string(code); }
    out.bytes("[");
    for (std::size_t i = 0; i < colors.size() && out.open(); ++i) {
        const Rgb8& color = colors[i];
        out.bytes(i > 0 ? ",[" : "[");
        out.bytes(codes[color[0]]);
        out.bytes(",");
        out.bytes(codes[color[1]]);
        out.bytes(",");
        out.bytes(codes[color[2]]);
        out.bytes("]");
    }
    out.bytes("]");
}

std::string units_of_quantities(const Quantities& wanted, const UnitNames& units)
{
    ObjectWriter names;
    if (wanted.irradiance) { names.text("irradiance", units.irradiance); }
    if (wanted.radiance) { names.text("radiance", units.radiance); }
    if (wanted.per_light) { names.text("per_light", units.irradiance); }
    if (wanted.color) { names.text("color", "sRGB 8-bit"); }
    if (wanted.visibility) { names.text("visibility", "1"); }
    if (wanted.normal) { names.text("normal", "1"); }
    if (wanted.ambient_occlusion) { names.text("ambient_occlusion", "1"); }
    if (wanted.standard_error) { names.text("standard_error", units.irradiance); }
    if (wanted.sh) { names.text("sh", "sr"); }
    return names.done();
}

void write_lights(BlockOut& out, Members& json, const Derived& derived, const Quantities& wanted)
{
    const std::vector<Light>& lights = derived.lit->scene.lights;
    if (wanted.visibility) {
        json.name("visibility");
        Members each(out);
        for (std::size_t l = 0; l < lights.size(); ++l) {
            if (lights[l].enabled) { each.array(lights[l].name, derived.visible[l], 1); }
        }
        each.done();
    }
    if (wanted.per_light) {
        json.name("per_light");
        Members each(out);
        for (std::size_t l = 0; l < lights.size(); ++l) {
            each.array(lights[l].name, floats(derived.lit->shaded.per_light[l]), 3);
        }
        each.done();
    }
}

}  // namespace

Encoding json_answer(const Derived& derived, const Quantities& wanted)
{
    return {0, [&derived, wanted](const Sink& sink) {
                const Lit& lit = *derived.lit;
                BlockOut out(sink);
                Members json(out);
                json.raw("vertices", std::to_string(lit.stage.mesh->positions.size()));
                json.raw("units", units_of_quantities(wanted, unit_names(lit.scene.units)));
                json.raw("view", view_json(lit.scene));
                if (wanted.color) {
                    json.raw("display", display_json(derived.display));
                    json.name("color");
                    write_colors(out, derived.color);
                }
                if (wanted.irradiance) {
                    json.array("irradiance", floats(lit.shaded.irradiance), 3);
                }
                if (wanted.radiance) { json.array("radiance", floats(lit.shaded.radiance), 3); }
                if (wanted.normal) { json.array("normal", derived.normals, 3); }
                if (wanted.ambient_occlusion) {
                    json.array("ambient_occlusion", lit.transport.sky->ambient_occlusion, 1);
                }
                if (wanted.standard_error) {
                    json.array("standard_error", floats(lit.shaded.standard_error), 3);
                }
                if (wanted.sh) { json.array("sh", lit.transport.sky->sh, sh_coefficients); }
                write_lights(out, json, derived, wanted);
                json.raw("warnings", text_array(lit.warnings));
                json.done();
                return out.flush();
            }};
}

}  // namespace relight
