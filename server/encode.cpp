#include "server/encode.h"

#include "core/io/writers.h"
#include "server/answer_parts.h"
#include "server/derived.h"
#include "server/gltf_answer.h"
#include "server/json_text.h"
#include "server/json_tree.h"

namespace relight {
namespace {

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

Result<Encoding> new_glb(const LitMesh& out)
{
    Encoding glb = encode_glb(out);
    if (glb.bytes > 0) { return glb; }
    return make_error(Fault::NotAvailable,
                      "the answer is larger than 4 GiB, and a GLB cannot be; take ply, vtp or npz",
                      "/output/format");
}

/// JSON that fits in one block is written at once: so its length is known before it is sent. Of a
/// larger mesh it is not tried.
Encoding short_or_streamed(Encoding json, std::size_t vertices)
{
    constexpr std::size_t few = 4096;
    if (vertices > few) { return json; }
    std::string text;
    const bool is_short = json.write([&](std::string_view bytes) {
        text += bytes;
        return text.size() <= BlockOut::block_bytes;
    });
    return is_short ? sent_whole(std::move(text)) : json;
}

/// `derived` must outlive it.
Result<Encoding> answer_in(Format format, const Derived& derived, const Output& output, bool last)
{
    if (format == Format::Json) {
        return short_or_streamed(json_answer(derived, output.quantities),
                                 derived.lit->stage.mesh->positions.size());
    }
    if (format == Format::Fields) { return fields_answer(derived, output, last); }
    const std::vector<std::byte>& source = derived.lit->source;
    const LitMesh out = lit_mesh(derived, output.quantities, format);
    switch (format) {
        case Format::Npz:
            return encode_npz(out);
        case Format::Obj:
            return encode_obj(out);
        case Format::Off:
            return encode_off(out);
        case Format::Vtp:
            return encode_vtp(out);
        case Format::Las:
            return encode_las(source, out.color);
        case Format::Glb:
            return source.empty() ? new_glb(out) : add_to_gltf(source, out);
        case Format::PlyAscii:
            return encode_ply(out, PlyEncoding::Ascii);
        default:
            return encode_ply(out);
    }
}

/// The same while what it shows is kept.
Encoding keeping(const std::shared_ptr<const Derived>& derived, Encoding encoding)
{
    auto write = std::move(encoding.write);
    encoding.write = [derived, write = std::move(write)](const Sink& sink) { return write(sink); };
    return encoding;
}

}  // namespace

bool keeps_source(Format format, const Mesh& mesh)
{
    return format == Format::Las || (format == Format::Glb && !mesh.pieces.empty());
}

Result<Encoding> encode_mesh(const std::shared_ptr<Lit>& lit, Display display, const Output& output,
                             Format format, bool last, unsigned threads, Progress& progress)
{
    const Quantities& wanted = output.quantities;
    auto made = std::make_shared<Derived>();
    made->lit = lit;
    if (wanted.color) {
        if (display.auto_exposure) { display.exposure_ev = auto_exposure_ev(lit->shaded.radiance); }
        made->color = to_srgb8(lit->shaded.radiance, display, threads, progress);
    }
    made->display = display;
    if (wanted.visibility) {
        made->visible = visibilities(lit->transport, lit->stage.mesh->positions.size());
    }
    // A slow client holds what is sent, not what it was made of.
    lit->transport.columns.clear();
    lit->transport.drawn.clear();
    lit->stage.bvh = nullptr;
    const bool arrays = format == Format::Json || format == Format::Fields;
    if (wanted.normal && arrays) { made->normals = normal_floats(lit->stage.surface->normals); }
    if (wanted.sh && !arrays && format != Format::Npz) {
        made->coefficients = columns_of(lit->transport.sky->sh, sh_coefficients);
    }
    auto answer = answer_in(format, *made, output, last);
    if (!answer) { return answer; }
    return keeping(made, std::move(*answer));
}

}  // namespace relight
