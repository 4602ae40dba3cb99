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
std::vector<std::vector<float>> visibilities(const Transport& transport)
{
    std::vector<std::vector<float>> all;
    for (const auto& column : transport.columns) {
        auto& one = all.emplace_back();
        if (column != nullptr) { one = column->visible; }
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

std::string normals_json(std::span<const Dir3> normals)
{
    std::vector<float> values;
    values.reserve(normals.size() * 3);
    for (const Dir3& n : normals) {
        for (const double x : {n.x(), n.y(), n.z()}) { values.push_back(static_cast<float>(x)); }
    }
    return array_json(values, 3);
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
    if (wanted.normal) { json.raw("normal", normals_json(lit.stage.surface->normals)); }
    if (wanted.ambient_occlusion) {
        json.raw("ambient_occlusion", array_json(lit.transport.ambient_occlusion, 1));
    }
    if (wanted.standard_error) {
        json.raw("standard_error", array_json(floats(lit.shaded.standard_error), 3));
    }
    if (wanted.sh) {
        json.raw("sh", array_json(lit.transport.sh, static_cast<int>(sh_coefficients)));
    }
    if (wanted.visibility) {
        const auto all = visibilities(lit.transport);
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

/// `out` in its format.
Result<std::string> written(const LitMesh& out, std::span<const std::byte> source, Format format)
{
    switch (format) {
        case Format::PlyAscii:
            return write_ply(out, PlyEncoding::Ascii);
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
            return write_ply(out, PlyEncoding::BinaryLittleEndian);
    }
}

Result<std::string> file_answer(const Lit& lit, const Display& display, const Quantities& wanted,
                                std::span<const Rgb8> color, Format format)
{
    const UnitNames units = unit_names(lit.scene.units);
    const auto names = property_names(lit.scene.lights);
    const auto visible =
        wanted.visibility ? visibilities(lit.transport) : std::vector<std::vector<float>>{};
    LitMesh out{*lit.stage.mesh, {}, color, {}, {}};
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
        out.quantities.push_back({"ambient_occlusion", 1, lit.transport.ambient_occlusion});
    }
    if (wanted.standard_error) {
        out.quantities.push_back({"standard_error", 3, floats(lit.shaded.standard_error)});
        out.comments.push_back("standard_error of the irradiance, same unit");
    }
    const auto coefficients = wanted.sh && format != Format::Npz
                                  ? columns_of(lit.transport.sh, sh_coefficients)
                                  : std::vector<std::vector<float>>{};
    for (std::size_t k = 0; k < coefficients.size(); ++k) {
        out.quantities.push_back({"sh_" + std::to_string(k), 1, coefficients[k]});
    }
    if (wanted.sh && format == Format::Npz) {
        out.quantities.push_back({"sh", static_cast<int>(sh_coefficients), lit.transport.sh});
    }
    for (std::size_t l = 0; l < visible.size(); ++l) {
        if (!visible[l].empty()) {
            out.quantities.push_back({"visibility_" + names[l], 1, visible[l]});
        }
    }
    for (std::size_t l = 0; l < lit.shaded.per_light.size(); ++l) {
        out.quantities.push_back({"per_light_" + names[l], 3, floats(lit.shaded.per_light[l])});
    }
    if (wanted.color) {
        out.comments.push_back("color is sRGB, exposure_ev " + decimal(display.exposure_ev) +
                               ", tone_map " + std::string(tone_map_name(display.tone_map)));
    }
    for (const std::string& warning : lit.warnings) {
        out.comments.push_back("warning: " + warning);
    }
    return written(out, lit.source, format);
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

Result<std::string> encode_mesh(const Lit& lit, Display display, const Quantities& wanted,
                                Format format, unsigned threads, Progress& progress)
{
    std::vector<Rgb8> color;
    if (wanted.color) {
        if (display.auto_exposure) { display.exposure_ev = auto_exposure_ev(lit.shaded.radiance); }
        color = to_srgb8(lit.shaded.radiance, display, threads, progress);
    }
    if (format == Format::Json) { return json_answer(lit, display, wanted, color); }
    return file_answer(lit, display, wanted, color, format);
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
