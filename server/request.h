#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/display/display.h"
#include "core/geometry/surface.h"
#include "core/scene.h"

namespace relight {

/// Where the mesh of a request comes from.
struct StoredMesh {
    std::string id;  ///< 64 hex digits
};
struct PartMesh {
    std::string part;  ///< name of a file part of the multipart body
};
using MeshSource = std::variant<StoredMesh, PartMesh, Mesh>;

enum class Format { Ply, PlyAscii, Json, Npz, Png };
constexpr bool is_image(Format format)
{
    return format == Format::Png;
}

enum class Renderer { Raytrace, Vtk };

struct Quantities {
    bool color = false, irradiance = false, radiance = false, visibility = false, normal = false,
         per_light = false;
};

/// How the answer is written.
struct Output {
    std::optional<Format> format;  ///< absent: by the Accept header
    Quantities quantities;
    int width = 800, height = 600;
    int samples = 16;                       ///< a pixel
    std::optional<Rgb> background = Rgb{};  ///< linear radiance; nothing: transparent
    Renderer renderer = Renderer::Raytrace;
    std::optional<std::string> image_field;  ///< the first field given that only images have
};

/// What of the camera the request says; the rest frames the mesh.
struct CameraFields {
    std::optional<Point3> eye, target;
    std::optional<Dir3> up;
    std::optional<double> fov_y;  ///< [rad]
};

/// A relight request, validated as far as it can be without its mesh.
struct RelightRequest {
    MeshSource mesh;
    Scene scene;
    CameraFields camera;
    bool default_lights = true;  ///< the request names none
    double point_radius_scale = 1.5;
    Display display;
    Output output;
};

struct ParseLimits {
    std::uint64_t vertices = 100'000'000;
    std::uint64_t faces = 200'000'000;
    std::uint64_t pixels = 33'554'432;  ///< of one image
    std::uint64_t lights = 256;
};

}  // namespace relight
