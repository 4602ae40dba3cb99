#include "core/geometry/normal_map.h"

#include <algorithm>

#include "core/geometry/filled.h"
#include "core/geometry/tangents.h"

namespace relight {

Dir3 bent_normal(Dir3 smooth, Vec3 tangent, double bitangent_sign, const Texture& texture,
                 const MaterialMaps& maps, Uv uv)
{
    const Vec3 N = smooth;
    const Dir3 T = normalize(tangent - N * dot(tangent, N));
    const Rgb code = sample_linear(texture, *maps.normal, uv).rgb;
    const double scale = static_cast<double>(maps.normal_scale);
    const Dir3 told =
        normalize({(2.0 * code.r - 1.0) * scale, (2.0 * code.g - 1.0) * scale, 2.0 * code.b - 1.0});
    if (!smooth || !T || !told) { return smooth; }
    constexpr double least_z = 0.01;  // cosine; a surface shows no side that it turns away
    const Vec3 B = cross(N, T) * bitangent_sign;
    return normalize(Vec3(T) * told.x() + B * told.y() + N * std::max(told.z(), least_z));
}

namespace {

/// One vertex.
void bend(const Mesh& mesh, std::size_t v, Surface& surface)
{
    const std::uint32_t group = surface.vertex_groups[v];
    if (group == no_group || !mesh.maps[group].normal) { return; }
    const MaterialMaps& maps = mesh.maps[group];
    const std::vector<Uv>& uvs = maps.normal->uv_set == 1 ? mesh.uvs_1 : mesh.uvs;
    if (uvs.empty()) { return; }
    const auto& tangent = surface.tangents[v];
    surface.normals[v] = bent_normal(surface.smooth_normals[v], direction_of(tangent),
                                     static_cast<double>(tangent[3]),
                                     mesh.textures[maps.normal->texture], maps, uvs[v]);
}

}  // namespace

void apply_normal_maps(const Mesh& mesh, unsigned threads, Progress& progress, Surface& surface)
{
    const bool any = std::any_of(mesh.maps.begin(), mesh.maps.end(),
                                 [](const MaterialMaps& maps) { return maps.normal.has_value(); });
    if (!any || surface.vertex_groups.empty() || surface.tangents.empty()) { return; }
    surface.smooth_normals = filled<Dir3>(surface.normals.size(), progress);
    constexpr std::size_t block = 4096;
    parallel_for(surface.normals.size(), block, threads, progress,
                 [&](std::size_t begin, std::size_t end) {
                     for (std::size_t v = begin; v < end; ++v) {
                         surface.smooth_normals[v] = surface.normals[v];
                         bend(mesh, v, surface);
                     }
                 });
}

}  // namespace relight
