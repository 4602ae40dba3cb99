#pragma once

#include <algorithm>
#include <limits>
#include <string_view>

#include "core/geometry/mesh.h"

namespace relight {

/// Where the writers that can say so put vertex i: NaN if the file keeps a place without a point.
inline Point3 filed_position(const Mesh& mesh, std::size_t i)
{
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    const bool absent = std::binary_search(mesh.absent.begin(), mesh.absent.end(), i);
    return absent ? Point3{nan, nan, nan} : mesh.positions[i];
}

/// Texture coordinates as PLY, OBJ, OFF and VTK mean them: v grows upward. Readers keep what a file
/// says, so only those that came as glTF, where v grows downward, are turned over.
class FiledUv {
  public:
    explicit FiledUv(const Mesh& mesh) : downward_(mesh.format == "glb" || mesh.format == "gltf") {}
    Uv operator()(Uv uv) const { return {uv[0], downward_ ? 1.0F - uv[1] : uv[1]}; }

  private:
    bool downward_;
};

}  // namespace relight
