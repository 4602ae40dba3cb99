#include "server/mesh_file.h"

#include <algorithm>

#include "core/geometry/spacing.h"
#include "server/import_process.h"
#include "server/json_text.h"
#include "server/json_tree.h"
#include "server/negotiate.h"
#include "server/request.h"

namespace relight {
namespace {

constexpr double default_radius_scale = Points{}.radius_scale;

constexpr std::string_view readable_formats =
    "ply, obj, off, stl, glb, gltf, xyz, txt, pts, pcd, las";

/// What a file of a kind we do not read starts with.
struct Magic {
    std::string_view bytes, kind;
};
constexpr Magic magics[] = {{"\x76\x2f\x31\x01", "an OpenEXR image; it goes to /v1/environments"},
                            {"#?", "a Radiance image; it goes to /v1/environments"},
                            {"IESNA", "a photometric profile; it goes to /v1/profiles"},
                            {"\x1f\x8b", "gzip data; unpack it first"},
                            {"PK\x03\x04", "a ZIP; unpack it first"},
                            {"\x89PNG", "a PNG image"},
                            {"\xff\xd8\xff", "a JPEG image"}};

bool is_gltf_media(std::string_view content_type)
{
    const std::string type = essence(content_type);
    return type == "model/gltf-binary" || type == "model/gltf+json";
}

/// GLB's magic, or a JSON object: no other mesh starts with a brace.
bool starts_as_gltf(std::string_view file)
{
    if (file.starts_with("\xef\xbb\xbf")) { file.remove_prefix(3); }
    const auto first = file.substr(0, 4096).find_first_not_of(" \t\r\n");
    return file.starts_with("glTF") || (first != std::string_view::npos && file[first] == '{');
}

/// Our own reader for the file; nothing: it is a glTF.
Result<std::optional<MeshFormat>> choose_reader(std::optional<std::string_view> named,
                                                std::string_view content_type,
                                                std::span<const std::byte> file)
{
    using Chosen = std::optional<MeshFormat>;
    if (named) {
        if (*named == "glb" || *named == "gltf") { return Chosen(); }
        if (const auto format = mesh_format_named(*named)) { return Chosen(format); }
        if (*named == "laz") { return Chosen(MeshFormat::Las); }  // which says what to do about it
        return make_error(Fault::UnknownFormat,
                          "format \"" + printable(*named) +
                              "\" is not read; these are: " + std::string(readable_formats));
    }
    if (is_gltf_media(content_type)) { return Chosen(); }
    if (const auto format = mesh_format_of_media(content_type)) { return Chosen(format); }
    const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
    for (const Magic& magic : magics) {
        if (!text.starts_with(magic.bytes)) { continue; }
        return make_error(Fault::NotAvailable,
                          "this looks like " + std::string(magic.kind) +
                              "; meshes and clouds are: " + std::string(readable_formats));
    }
    if (starts_as_gltf(text)) { return Chosen(); }
    if (const auto format = mesh_format_of_bytes(file)) { return Chosen(format); }
    return make_error(Fault::UnknownFormat,
                      "the first bytes are of no format that is read (" +
                          std::string(readable_formats) +
                          "); name it by ?format= or Content-Type if they mislead");
}

std::string intake_json(const Intake& intake, bool is_cloud)
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
        .count("normals_estimated", intake.normals_estimated)
        .count("normals_opposing", intake.normals_opposing)
        .count("polygons_triangulated", intake.polygons_triangulated)
        .count("absent_points", intake.absent_points)
        .number("expected_light_leak", is_cloud ? expected_leak(default_radius_scale) : 0.0)
        .raw("wound_inward", intake.wound_inward ? "true" : "false")
        .raw("recentring_shift", json_of(intake.recentring_shift))
        .raw("notes", text_array(intake.notes))
        .done();
}

}  // namespace

Result<Asset> read_mesh_file(std::span<const std::byte> file, std::optional<std::string_view> named,
                             std::string_view content_type, const ReadLimits& limits,
                             std::uint64_t pixels, Progress& progress)
{
    if (file.empty()) { return make_error(Fault::EmptyFile, "the file has no bytes"); }
    const auto read = [&](std::optional<MeshFormat> format) -> Result<Asset> {
        if (!format) {
            ImportLimits import;
            import.vertices = limits.vertices;
            import.faces = limits.faces;
            import.pixels = pixels;
            return import_gltf(file, import, progress);
        }
        return read_mesh(*format, file, limits, progress).transform([](Mesh&& mesh) {
            return Asset{std::move(mesh), {}, {}};
        });
    };
    return choose_reader(named, content_type, file).and_then(read);
}

std::string_view media_type_of(std::string_view format)
{
    if (format == "ply") { return "model/ply"; }
    if (format == "obj") { return "model/obj"; }
    if (format == "stl") { return "model/stl"; }
    if (format == "off") { return "model/off"; }
    if (format == "glb") { return "model/gltf-binary"; }
    if (format == "gltf") { return "model/gltf+json"; }
    if (format == "las") { return "application/vnd.las"; }
    if (format == "xyz" || format == "pts" || format == "pcd") { return "text/plain"; }
    if (format == "hdr") { return "image/vnd.radiance"; }
    if (format == "exr") { return "image/x-exr"; }
    return "application/octet-stream";
}

std::string describe(const std::string& id, std::uint64_t bytes, const Asset& asset,
                     const Surface& surface, const Intake& intake)
{
    const Mesh& mesh = asset.mesh;
    std::vector<std::string> lights;
    for (const Light& light : asset.lights) { lights.push_back(light.name); }
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
                        .flag("lights", !asset.lights.empty())
                        .done())
        .raw("materials", text_array(mesh.materials))
        .raw("lights", text_array(lights))
        .raw("intake", intake_json(intake, mesh.faces.count() == 0))
        .done();
}

}  // namespace relight
