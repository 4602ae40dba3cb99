#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/asset.h"
#include "core/display/display.h"
#include "core/geometry/surface.h"
#include "core/io/fields_writer.h"
#include "core/scene.h"

namespace relight {

/// Where the mesh of a request comes from.
struct StoredMesh {
    std::string id;  ///< 64 hex digits
};
struct PartMesh {
    std::string part;  ///< name of a file part of the multipart body
};
using InlineMesh = std::shared_ptr<const Asset>;  ///< in the request itself
using MeshSource = std::variant<StoredMesh, PartMesh, InlineMesh>;

enum class Format {
    Ply,
    PlyAscii,
    Obj,
    Off,
    Glb,
    Vtp,
    Las,
    Json,
    Npz,
    Fields,  ///< raw arrays, asked for by ?fields=
    Png,
    Jpeg,
    Exr,
    Hdr
};
constexpr bool is_image(Format format)
{
    return format >= Format::Png;
}
/// A picture of display colours; the others hold radiance.
constexpr bool is_display_image(Format format)
{
    return format == Format::Png || format == Format::Jpeg;
}

enum class Renderer { Raytrace, Vtk };

struct Quantities {
    bool color = false, irradiance = false, radiance = false, visibility = false, normal = false,
         per_light = false, ambient_occlusion = false, standard_error = false, sh = false;
};

/// An array of ?fields=.
struct FieldWanted {
    std::string quantity;  ///< "irradiance"; "visibility" and "per_light" are one a light
    FieldType type = FieldType::Float32;
};

/// How the answer is written.
struct Output {
    std::optional<Format> format;   ///< absent: by the Accept header
    Quantities quantities;          ///< color if the request names none:
    bool names_quantities = false;  ///< an EXR, which has no color, may then leave it out
    int width = 800, height = 600;
    int samples = 16;  ///< a pixel
    int quality = 92;  ///< of a JPEG, 1..100
    /// Linear radiance where nothing is hit; absent: the skies among the lights, else black.
    std::optional<Rgb> background;
    bool transparent = false;  ///< "background": "transparent"
    Renderer renderer = Renderer::Raytrace;
    std::vector<FieldWanted> fields;         ///< of Format::Fields
    bool progressive = false;                ///< Format::Fields: message after message
    std::optional<std::string> image_field;  ///< the first field given that only images have
};

/// What of the camera the request says; the rest frames the mesh.
struct CameraFields {
    std::optional<Point3> eye, target;
    std::optional<Dir3> up;
    std::optional<double> fov_y;  ///< [rad]
};

/// A file that a light of the request needs: an environment's image or a photometric profile.
struct LightFile {
    std::size_t light = 0;                      ///< its place among the lights
    std::variant<StoredMesh, PartMesh> source;  ///< by id, or a part of the body
    std::string pointer;                        ///< "/lights/2/image"
};

/// A sky of the request. Its table takes a hundredth of a second, so complete() makes it.
struct ClearSky {
    std::size_t light = 0;  ///< its place among the lights
    Dir3 toward_sun;
    double turbidity = 3.0;
};

/// "points": how a cloud becomes a surface.
struct Points {
    double radius_scale = 1.5;     ///< of its discs, in units of the local spacing
    std::optional<bool> estimate;  ///< normals: true "estimate", false "file"; absent: the file's,
                                   ///< else estimated
    std::optional<Point3> viewpoint;  ///< estimated normals face it; absent: as the file says
};

/// One entry of "materials", to be matched with the mesh's groups.
struct GroupMaterial {
    std::string group;  ///< the key: a name of the mesh's materials, or an index into them
    Material material;
};

/// A relight request, validated as far as it can be without its mesh.
struct RelightRequest {
    MeshSource mesh;
    Scene scene;
    std::vector<LightFile> light_files;
    std::vector<ClearSky> skies;
    std::vector<GroupMaterial> materials;
    CameraFields camera;
    bool default_material = true;         ///< the request names none: the file's own
    bool default_lights = true;           ///< the request names none
    std::vector<std::uint64_t> vertices;  ///< POST /v1/explain: which to explain
    Points points;
    std::optional<double> max_edge;  ///< "refine": longest edge allowed, scene units
    Display display;
    Output output;
    bool receipt = false;
};

struct ParseLimits {
    std::uint64_t vertices = 100'000'000;
    std::uint64_t faces = 200'000'000;
    std::uint64_t pixels = 33'554'432;  ///< of one image
    std::uint64_t lights = 256;
};

}  // namespace relight
