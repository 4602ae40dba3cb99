#include "server/mesh_file.h"

#include <algorithm>
#include <array>

#include "server/json_text.h"
#include "server/json_tree.h"
#include "server/negotiate.h"

namespace relight {
namespace {

constexpr std::string_view readable_formats = "ply, obj, off, stl";

/// Formats of the contract that this build does not read.
constexpr std::array<std::string_view, 11> later_formats = {
    "gltf", "glb", "pcd", "las", "laz", "xyz", "pts", "txt", "exr", "hdr", "ies"};

/// What a file of a kind we do not read starts with.
struct Magic {
    std::string_view bytes, kind;
};
constexpr Magic magics[] = {
    {"glTF", "a GLB"},         {"LASF", "a LAS cloud"},    {"\x76\x2f\x31\x01", "an OpenEXR image"},
    {"\x1f\x8b", "gzip data"}, {"\x89PNG", "a PNG image"}, {"\xff\xd8\xff", "a JPEG image"},
    {"PK\x03\x04", "a ZIP"},   {"#?", "a Radiance image"}, {"IESNA", "a photometric profile"},
    {"# .PCD", "a PCD cloud"}};

/// What else the file is, as far as its first bytes tell; empty if they do not.
std::string_view foreign_kind(std::string_view file)
{
    for (const Magic& magic : magics) {
        if (file.starts_with(magic.bytes)) { return magic.kind; }
    }
    const auto first = file.substr(0, 4096).find_first_not_of(" \t\r\n");
    if (first == std::string_view::npos) { return {}; }
    if (file[first] == '{') { return "JSON (a glTF?)"; }
    if (file.substr(first).starts_with("VERSION")) { return "a PCD cloud"; }
    return {};
}

Error not_available(std::string_view kind)
{
    return make_error(Fault::NotAvailable, "this looks like " + std::string(kind) +
                                               ", which this build does not read; it reads: " +
                                               std::string(readable_formats));
}

std::string intake_json(const Intake& intake)
{
    return ObjectWriter()
        .count("degenerate_faces", intake.degenerate_faces)
        .count("duplicate_faces", intake.duplicate_faces)
        .count("non_manifold_edges", intake.non_manifold_edges)
        .count("boundary_edges", intake.boundary_edges)
        .count("inconsistent_edges", intake.inconsistent_edges)
        .count("unreferenced_vertices", intake.unreferenced_vertices)
        .count("unlit_vertices", intake.unlit_vertices)
        .count("normals_computed", intake.normals_computed)
        .count("normals_opposing", intake.normals_opposing)
        .count("polygons_triangulated", intake.polygons_triangulated)
        .raw("wound_inward", intake.wound_inward ? "true" : "false")
        .raw("recentring_shift", json_of(intake.recentring_shift))
        .raw("notes", text_array(intake.notes))
        .done();
}

}  // namespace

Result<MeshFormat> choose_mesh_format(std::optional<std::string_view> named,
                                      std::string_view content_type,
                                      std::span<const std::byte> file)
{
    const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    if (named) {
        if (const auto format = mesh_format_named(*named)) { return *format; }
        const bool later =
            std::find(later_formats.begin(), later_formats.end(), *named) != later_formats.end();
        return make_error(
            later ? Fault::NotAvailable : Fault::UnknownFormat,
            "format \"" + printable(*named) +
                "\" is not read by this build; it reads: " + std::string(readable_formats));
    }
    if (file.empty()) { return make_error(Fault::EmptyFile, "the file has no bytes"); }
    if (const auto format = mesh_format_of_media(content_type)) { return *format; }
    const std::string_view kind = foreign_kind(text);
    const std::string type = essence(content_type);
    if (type.starts_with("model/gltf")) { return not_available(kind.empty() ? "a glTF" : kind); }
    if (!kind.empty()) { return not_available(kind); }
    if (const auto format = mesh_format_of_bytes(file)) { return *format; }
    return make_error(Fault::UnknownFormat,
                      "the first bytes are of no format this build reads (" +
                          std::string(readable_formats) +
                          "); name it by ?format= or Content-Type if they mislead");
}

std::string_view media_type_of(std::string_view format)
{
    if (format == "ply") { return "model/ply"; }
    if (format == "obj") { return "model/obj"; }
    if (format == "stl") { return "model/stl"; }
    if (format == "off") { return "model/off"; }
    if (format == "hdr") { return "image/vnd.radiance"; }
    if (format == "exr") { return "image/x-exr"; }
    return "application/octet-stream";
}

std::string describe(const std::string& id, std::uint64_t bytes, const Mesh& mesh,
                     const Surface& surface, const Intake& intake)
{
    const Bounds& b = surface.bounds;
    return ObjectWriter()
        .text("id", id)
        .text("kind", mesh.faces.count() > 0 ? "mesh" : "points")
        .text("format", mesh.format)
        .count("bytes", bytes)
        .count("vertices", mesh.positions.size())
        .count("faces", mesh.faces.count())
        .raw("bounds", ObjectWriter()
                           .raw("min", json_of(b.min - Point3{}))
                           .raw("max", json_of(b.max - Point3{}))
                           .done())
        .raw("has", ObjectWriter()
                        .flag("normals", !mesh.normals.empty())
                        .flag("colors", !mesh.colors.empty())
                        .flag("uvs", !mesh.uvs.empty() || !mesh.corner_uvs.empty())
                        .flag("materials", !mesh.materials.empty())
                        .flag("lights", false)
                        .done())
        .raw("materials", text_array(mesh.materials))
        .raw("lights", "[]")
        .raw("intake", intake_json(intake))
        .done();
}

}  // namespace relight
