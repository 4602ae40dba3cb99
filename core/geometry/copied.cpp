#include "core/geometry/copied.h"

namespace relight {

Mesh copied_without_faces(const Mesh& mesh, const Progress& progress)
{
    Mesh copy;
    copy.format = mesh.format;
    copy.positions = copied(mesh.positions, progress);
    copy.absent = copied(mesh.absent, progress);
    copy.double_positions = mesh.double_positions;
    copy.normals = copied(mesh.normals, progress);
    copy.colors = copied(mesh.colors, progress);
    copy.uvs = copied(mesh.uvs, progress);
    copy.uvs_1 = copied(mesh.uvs_1, progress);
    copy.tangents = copied(mesh.tangents, progress);
    copy.materials = mesh.materials;
    copy.maps = mesh.maps;
    for (const Texture& t : mesh.textures) {
        copy.textures.push_back({t.width, t.height, copied(t.texels, progress)});
    }
    copy.viewpoint = mesh.viewpoint;
    copy.pieces = mesh.pieces;
    copy.notes = mesh.notes;
    return copy;
}

void copy_faces(const Mesh& from, Mesh& to, const Progress& progress)
{
    to.faces.indices = copied(from.faces.indices, progress);
    to.faces.offsets = copied(from.faces.offsets, progress);
    to.corner_uvs = copied(from.corner_uvs, progress);
    to.face_materials = copied(from.face_materials, progress);
}

void reserve_vertices(Mesh& mesh, std::size_t vertices, const Progress& progress)
{
    const auto reserve = [&](auto& values) {
        if (!values.empty()) { values = copied(values, progress, vertices); }
    };
    reserve(mesh.positions);
    reserve(mesh.normals);
    reserve(mesh.colors);
    reserve(mesh.uvs);
    reserve(mesh.uvs_1);
    reserve(mesh.tangents);
}

}  // namespace relight
