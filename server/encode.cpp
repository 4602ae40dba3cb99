#include "server/encode.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/io/writers.h"
#include "server/gltf_answer.h"
#include "server/json_text.h"
#include "server/json_tree.h"

namespace relight {
namespace {

std::span<const float> floats(std::span<const Rgbf> values)
{
    return {values.empty() ? nullptr : values.front().data(), values.size() * 3};
}

std::string_view tone_map_name(ToneMap map)
{
    switch (map) {
        case ToneMap::None:
            return "none";
        case ToneMap::Reinhard:
            return "reinhard";
        case ToneMap::ReinhardExtended:
            return "reinhard_extended";
        case ToneMap::AcesNarkowicz:
            return "aces_narkowicz";
        case ToneMap::AcesHill:
            return "aces_hill";
        case ToneMap::PbrNeutral:
            return "pbr_neutral";
    }
    return "none";
}

constexpr std::size_t sh_coefficients = 9;  // a vertex

struct UnitNames {
    std::string_view irradiance, radiance;
};
UnitNames unit_names(Units units)
{
    if (units == Units::Photometric) { return {"lx", "cd/m2"}; }
    return {"W/m2", "W/m2/sr"};
}

/// A light's name as a property or file name: letters, digits, '_'; still unique.
std::vector<std::string> property_names(const std::vector<Light>& lights)
{
    std::vector<std::string> names;
    std::set<std::string> taken;
    for (const Light& light : lights) {
        std::string name = light.name;
        for (char& c : name) {
            const bool plain =
                (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
            if (!plain) { c = '_'; }
        }
        while (!taken.insert(name).second) { name += '_'; }
        names.push_back(std::move(name));
    }
    return names;
}

/// The visibility of each light that was traced, as floats; empty for the others.
std::vector<std::vector<float>> visibilities(const Transport& transport, std::size_t vertices)
{
    std::vector<std::vector<float>> all;
    for (const auto& column : transport.columns) {
        auto& one = all.emplace_back();
        if (column == nullptr) { continue; }
        one.resize(vertices);
        for (std::size_t v = 0; v < vertices; ++v) { one[v] = column->visible[v]; }
    }
    return all;
}

std::string display_json(const Display& display)
{
    return ObjectWriter()
        .number("exposure_ev", display.exposure_ev)
        .text("tone_map", tone_map_name(display.tone_map))
        .text("transfer", "srgb")
        .done();
}

std::string array_json(std::span<const float> values, int components)
{
    std::string json;
    append_json(json, values, components);
    return json;
}

std::string color_json(std::span<const Rgb8> colors)
{
    std::string json = "[";
    for (const Rgb8& c : colors) {
        json += json.size() > 1 ? ",[" : "[";
        json +=
            std::to_string(c[0]) + ',' + std::to_string(c[1]) + ',' + std::to_string(c[2]) + ']';
    }
    return json + "]";
}

std::vector<float> normal_floats(std::span<const Dir3> normals)
{
    std::vector<float> values;
    values.reserve(normals.size() * 3);
    for (const Dir3& n : normals) {
        for (const double x : {n.x(), n.y(), n.z()}) { values.push_back(static_cast<float>(x)); }
    }
    return values;
}

/// Rows of `width` values, column by column.
std::vector<std::vector<float>> columns_of(std::span<const float> rows, std::size_t width)
{
    std::vector<std::vector<float>> columns(width, std::vector<float>(rows.size() / width));
    for (std::size_t i = 0; i < rows.size(); ++i) { columns[i % width][i / width] = rows[i]; }
    return columns;
}

std::string json_answer(const Lit& lit, const Display& display, const Quantities& wanted,
                        std::span<const Rgb8> color)
{
    const UnitNames units = unit_names(lit.scene.units);
    const std::vector<Light>& lights = lit.scene.lights;
    ObjectWriter json;
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
    json.count("vertices", lit.stage.mesh->positions.size()).raw("units", names.done());
    json.raw("view", view_json(lit.scene));
    if (wanted.color) {
        json.raw("display", display_json(display)).raw("color", color_json(color));
    }
    if (wanted.irradiance) { json.raw("irradiance", array_json(floats(lit.shaded.irradiance), 3)); }
    if (wanted.radiance) { json.raw("radiance", array_json(floats(lit.shaded.radiance), 3)); }
    if (wanted.normal) {
        json.raw("normal", array_json(normal_floats(lit.stage.surface->normals), 3));
    }
    if (wanted.ambient_occlusion) {
        json.raw("ambient_occlusion", array_json(lit.transport.sky->ambient_occlusion, 1));
    }
    if (wanted.standard_error) {
        json.raw("standard_error", array_json(floats(lit.shaded.standard_error), 3));
    }
    if (wanted.sh) {
        json.raw("sh", array_json(lit.transport.sky->sh, static_cast<int>(sh_coefficients)));
    }
    if (wanted.visibility) {
        const auto all = visibilities(lit.transport, lit.stage.mesh->positions.size());
        ObjectWriter each;
        for (std::size_t l = 0; l < lights.size(); ++l) {
            if (lights[l].enabled) { each.raw(lights[l].name, array_json(all[l], 1)); }
        }
        json.raw("visibility", each.done());
    }
    if (wanted.per_light) {
        ObjectWriter each;
        for (std::size_t l = 0; l < lights.size(); ++l) {
            each.raw(lights[l].name, array_json(floats(lit.shaded.per_light[l]), 3));
        }
        json.raw("per_light", each.done());
    }
    return json.raw("warnings", text_array(lit.warnings)).done();
}

Result<std::string> new_glb(const LitMesh& out)
{
    std::string glb = write_glb(out);
    if (!glb.empty()) { return glb; }
    return make_error(Fault::NotAvailable,
                      "the answer is larger than 4 GiB, and a GLB cannot be; take ply, vtp or npz",
                      "/output/format");
}

/// `out` in a format that is written before it is sent.
Result<std::string> written(const LitMesh& out, std::span<const std::byte> source, Format format)
{
    switch (format) {
        case Format::Npz:
            return write_npz(out);
        case Format::Obj:
            return write_obj(out);
        case Format::Off:
            return write_off(out);
        case Format::Vtp:
            return write_vtp(out);
        case Format::Las:
            return write_las(source, out.color);
        case Format::Glb:
            return source.empty() ? new_glb(out) : add_to_gltf(source, out);
        default:
            return write_ply(out, PlyEncoding::Ascii);
    }
}

/// What an answer shows that neither Transport nor Shaded holds as it is sent.
struct Derived {
    std::shared_ptr<const Lit> lit;
    Display display;
    std::vector<Rgb8> color;
    std::vector<std::vector<float>> visible;       ///< a light: V, or empty
    std::vector<std::vector<float>> coefficients;  ///< of sh, one by one: V
    std::vector<float> normals;                    ///< V x 3
};

/// The answer as a file; its spans are of `derived`.
LitMesh lit_mesh(const Derived& derived, const Quantities& wanted, Format format)
{
    const Lit& lit = *derived.lit;
    const UnitNames units = unit_names(lit.scene.units);
    const auto names = property_names(lit.scene.lights);
    LitMesh out{*lit.stage.mesh, {}, derived.color, {}, {}};
    if (wanted.normal || !lit.stage.mesh->normals.empty()) {
        out.normals = lit.stage.surface->normals;
    }
    if (wanted.irradiance) {
        out.quantities.push_back({"irradiance", 3, floats(lit.shaded.irradiance)});
        out.comments.push_back("irradiance in " + std::string(units.irradiance));
    }
    if (wanted.radiance) {
        out.quantities.push_back({"radiance", 3, floats(lit.shaded.radiance)});
        out.comments.push_back("radiance in " + std::string(units.radiance));
    }
    if (wanted.ambient_occlusion) {
        out.quantities.push_back({"ambient_occlusion", 1, lit.transport.sky->ambient_occlusion});
    }
    if (wanted.standard_error) {
        out.quantities.push_back({"standard_error", 3, floats(lit.shaded.standard_error)});
        out.comments.push_back("standard_error of the irradiance, same unit");
    }
    for (std::size_t k = 0; k < derived.coefficients.size(); ++k) {
        out.quantities.push_back({"sh_" + std::to_string(k), 1, derived.coefficients[k]});
    }
    if (wanted.sh && format == Format::Npz) {
        out.quantities.push_back({"sh", static_cast<int>(sh_coefficients), lit.transport.sky->sh});
    }
    for (std::size_t l = 0; l < derived.visible.size(); ++l) {
        if (!derived.visible[l].empty()) {
            out.quantities.push_back({"visibility_" + names[l], 1, derived.visible[l]});
        }
    }
    for (std::size_t l = 0; l < lit.shaded.per_light.size(); ++l) {
        out.quantities.push_back({"per_light_" + names[l], 3, floats(lit.shaded.per_light[l])});
    }
    if (wanted.color) {
        out.comments.push_back("color is sRGB, exposure_ev " +
                               decimal(derived.display.exposure_ev) + ", tone_map " +
                               std::string(tone_map_name(derived.display.tone_map)));
    }
    for (const std::string& warning : lit.warnings) {
        out.comments.push_back("warning: " + warning);
    }
    return out;
}

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

/// Raw arrays, and in their head what else an answer says.
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

/// The same while what it shows is kept.
Encoding keeping(const std::shared_ptr<const Derived>& derived, Encoding encoding)
{
    auto write = std::move(encoding.write);
    encoding.write = [derived, write = std::move(write)](const Sink& sink) { return write(sink); };
    return encoding;
}

/// Pixels of display colours as PNG, or as JPEG, which has no alpha.
std::string picture_file(int width, int height, std::span<const Rgb8> pixels, const Output& output,
                         Format format, std::span<const unsigned char> alpha = {})
{
    return format == Format::Jpeg ? write_jpeg(width, height, pixels, output.quality)
                                  : write_png(width, height, pixels, alpha);
}

/// Divides what the background's share left of colour and light out of a pixel: PNG's alpha is
/// straight.
Rgbf straight(Rgbf mixed, float coverage)
{
    if (coverage > 0.0F) {
        for (float& band : mixed) { band /= coverage; }
    }
    return mixed;
}

}  // namespace

std::string units_json(Units units)
{
    const UnitNames names = unit_names(units);
    return ObjectWriter()
        .text("irradiance", names.irradiance)
        .text("radiance", names.radiance)
        .done();
}

std::string view_json(const Scene& scene)
{
    ObjectWriter json;
    if (std::holds_alternative<CameraView>(scene.view)) {
        json.text("type", "camera").raw("eye", json_of(scene.camera.eye - Point3{}));
    } else if (const auto* direction = std::get_if<DirectionView>(&scene.view)) {
        json.text("type", "direction").raw("toward_viewer", json_of(direction->toward_viewer));
    } else {
        json.text("type", "normal");
    }
    return json.done();
}

std::string encode_radiance(const Rendered& rendered, const Scene& scene, const Output& output,
                            Format format, const std::vector<std::string>& warnings)
{
    const Image& image = rendered.image;
    std::vector<std::string> comments{"radiance in " +
                                      std::string(unit_names(scene.units).radiance)};
    for (const std::string& warning : warnings) { comments.push_back("warning: " + warning); }
    if (format == Format::Hdr) {
        return write_hdr(image.width, image.height, image.pixels, comments);
    }
    std::vector<ExrLayer> layers{{"", 3, floats(image.pixels)}, {"A", 1, image.coverage}};
    if (output.quantities.standard_error) {
        layers.push_back({"standard_error", 3, floats(rendered.standard_error)});
    }
    if (output.quantities.normal) { layers.push_back({"normal", 3, floats(rendered.normal)}); }
    const auto names = property_names(scene.lights);
    for (std::size_t l = 0; l < rendered.per_light.size(); ++l) {
        layers.push_back({"per_light_" + names[l], 3, floats(rendered.per_light[l])});
    }
    return write_exr(image.width, image.height, layers, comments);
}

bool keeps_source(Format format, const Mesh& mesh)
{
    return format == Format::Las || (format == Format::Glb && !mesh.pieces.empty());
}

Encoding sent_whole(std::string bytes)
{
    const auto kept = std::make_shared<const std::string>(std::move(bytes));
    return {kept->size(), [kept](const Sink& sink) { return kept->empty() || sink(*kept); }};
}

Result<Encoding> encode_mesh(const std::shared_ptr<const Lit>& lit, Display display,
                             const Output& output, Format format, bool last, unsigned threads,
                             Progress& progress)
{
    const Quantities& wanted = output.quantities;
    const std::size_t vertices = lit->stage.mesh->positions.size();
    auto made = std::make_shared<Derived>();
    made->lit = lit;
    if (wanted.color) {
        if (display.auto_exposure) { display.exposure_ev = auto_exposure_ev(lit->shaded.radiance); }
        made->color = to_srgb8(lit->shaded.radiance, display, threads, progress);
    }
    made->display = display;
    if (format == Format::Json) {
        return sent_whole(json_answer(*lit, display, wanted, made->color));
    }
    if (wanted.visibility) { made->visible = visibilities(lit->transport, vertices); }
    if (format == Format::Fields) {
        if (wanted.normal) { made->normals = normal_floats(lit->stage.surface->normals); }
        return keeping(made, fields_answer(*made, output, last));
    }
    if (wanted.sh && format != Format::Npz) {
        made->coefficients = columns_of(lit->transport.sky->sh, sh_coefficients);
    }
    const LitMesh out = lit_mesh(*made, wanted, format);
    if (format == Format::Ply) { return keeping(made, encode_ply(out)); }
    return written(out, lit->source, format).transform(sent_whole);
}

std::string encode_image(const Image& image, Display display, const Output& output, Format format,
                         unsigned threads, Progress& progress)
{
    if (display.auto_exposure) {
        std::vector<Rgbf> seen;  // the background has no say
        for (std::size_t i = 0; i < image.pixels.size(); ++i) {
            if (image.coverage[i] > 0.0F) { seen.push_back(image.pixels[i]); }
        }
        display.exposure_ev = auto_exposure_ev(seen);
    }
    if (!output.transparent) {
        return picture_file(image.width, image.height,
                            to_srgb8(image.pixels, display, threads, progress), output, format);
    }
    std::vector<Rgbf> own(image.pixels.size());
    std::vector<unsigned char> alpha(image.pixels.size());
    for (std::size_t i = 0; i < own.size(); ++i) {
        own[i] = straight(image.pixels[i], image.coverage[i]);
        alpha[i] = to_code(static_cast<double>(image.coverage[i]));
    }
    return write_png(image.width, image.height, to_srgb8(own, display, threads, progress), alpha);
}

Result<std::string> encode_preview(const Stage& stage, const Scene& scene,
                                   std::span<const Rgbf> radiance, Display display,
                                   const Output& output, Format format, unsigned threads,
                                   Progress& progress)
{
    if (display.auto_exposure) { display.exposure_ev = auto_exposure_ev(radiance); }
    const auto colors = to_srgb8(radiance, display, threads, progress);
    PreviewOptions options;
    options.width = output.width;
    options.height = output.height;
    options.samples = output.samples;
    options.background = to_srgb8(output.background.value_or(Rgb{}), display);
    auto picture = preview(*stage.mesh, *stage.surface, colors, scene.camera, options, progress);
    if (!picture) { return std::move(picture).error(); }
    if (!output.transparent) {
        return picture_file(picture->width, picture->height, picture->pixels, output, format);
    }
    for (std::size_t i = 0; i < picture->pixels.size(); ++i) {
        const int alpha = picture->alpha[i];
        if (alpha == 0) { continue; }
        for (unsigned char& band : picture->pixels[i]) {  // drawn over black
            band = static_cast<unsigned char>(std::min(255, (band * 255 + alpha / 2) / alpha));
        }
    }
    return write_png(picture->width, picture->height, picture->pixels, picture->alpha);
}

}  // namespace relight
