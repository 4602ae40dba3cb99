#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/base/camera.h"
#include "core/bsdf/material.h"
#include "core/light/light.h"

namespace relight {

enum class Units { Radiometric, Photometric };

/// Whence radiance is seen, per vertex.
struct NormalView {};
struct CameraView {};  ///< from Scene::camera's eye
struct DirectionView {
    Dir3 toward_viewer;
};
using View = std::variant<NormalView, CameraView, DirectionView>;

enum class Terminator { None, Smooth };

struct TransportOptions {
    bool shadows = true;
    unsigned samples = 64;  ///< a vertex and sampled light; with a target: at most
    /// Each vertex stops when the standard error of its E is this small [W/m^2 or lx].
    std::optional<double> target_standard_error;
    unsigned bounces = 0;                        ///< of diffuse interreflection
    std::uint64_t seed = 0;                      ///< of every random number
    bool two_sided = false;                      ///< receivers take light on both faces
    Terminator terminator = Terminator::Smooth;  ///< of points inside triangles (images); a vertex
                                                 ///< is its own tangent plane
    std::optional<double> max_distance;  ///< occluders beyond it [scene units] do not shadow
};

/// The request, validated: what is to be computed. How it is written is the server's Output.
struct Scene {
    Units units = Units::Radiometric;
    double length_unit_m = 1.0;  ///< metres in one length unit of the file
    std::vector<Light> lights;
    std::vector<Material> materials{Lambert{}};  ///< at least one; the first is for all the rest
    /// Mesh::materials' index -> index into `materials`; empty: the first for all.
    std::vector<std::uint32_t> material_of_group;
    /// One a material: the file's own, which its textures vary (Mesh::maps of the face's group);
    /// empty: none is.
    std::vector<bool> textured;
    View view = NormalView{};
    Camera camera;
    TransportOptions transport;
};

}  // namespace relight
