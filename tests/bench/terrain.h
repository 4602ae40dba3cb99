#pragma once

#include <cstddef>
#include <string>

#include "core/trace/stage.h"

namespace relight::bench {

/// A square heightfield of about `vertices` vertices (the nearest square number) and two triangles
/// for each, over [-1, 1]^2, facing +z: the same hills at every size, more finely sampled.
Mesh terrain(std::size_t vertices);

/// That terrain, prepared; made once and kept.
const Stage& terrain_stage(std::size_t vertices);

/// Its vertices alone, with their normals: a cloud, whose points are discs. Made once and kept.
const Stage& cloud_stage(std::size_t points);

/// That terrain turned to face +y, and above it a sphere of 1,280 triangles, which are its first.
/// Made once and kept.
const Stage& outdoor_stage(std::size_t vertices);
constexpr std::size_t lamp_triangles = 1280;

/// That terrain as files with normals: binary PLY (50 MB for a million vertices), GLB, and OBJ;
/// without: binary STL.
const std::string& terrain_ply(std::size_t vertices);
const std::string& terrain_glb(std::size_t vertices);
const std::string& terrain_obj(std::size_t vertices);
const std::string& terrain_stl(std::size_t vertices);

}  // namespace relight::bench
