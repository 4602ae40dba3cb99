#include "core/io/obj_corners.h"

#include <algorithm>
#include <span>
#include <string>
#include <tuple>

namespace relight {
namespace {

constexpr std::uint32_t none = ObjCorners::none;

/// Sum of the distinct unit normals, normalised. Sorted by value first: the order of the faces, and
/// a file that repeats one normal under many numbers, change nothing.
Vec3 merged(std::span<std::uint32_t> named, const std::vector<Vec3>& normals)
{
    const auto key = [&](std::uint32_t i) {
        return std::tuple(normals[i].x, normals[i].y, normals[i].z);
    };
    std::sort(named.begin(), named.end(), [&](auto a, auto b) { return key(a) < key(b); });
    Vec3 sum;
    for (std::size_t i = 0; i < named.size(); ++i) {
        if (i == 0 || key(named[i]) != key(named[i - 1])) { sum += normalize(normals[named[i]]); }
    }
    return normalize(sum);
}

/// Normals named by the corners of each vertex, vertex after vertex.
struct NormalsOfVertices {
    std::vector<std::uint32_t> named;
    std::vector<std::uint32_t> begin;  // V + 1
};

NormalsOfVertices gather(const Faces& faces, std::size_t vertices, const ObjCorners& filed)
{
    NormalsOfVertices of{{}, std::vector<std::uint32_t>(vertices + 1)};
    for (std::size_t c = 0; c < faces.indices.size(); ++c) {
        if (filed.normal_of[c] != none) { ++of.begin[faces.indices[c]]; }
    }
    std::uint32_t end = 0;
    for (std::uint32_t& count : of.begin) { count = end += count; }  // now the end of each vertex
    of.named.resize(end);
    for (std::size_t c = faces.indices.size(); c-- > 0;) {  // filling backwards leaves the begin
        if (filed.normal_of[c] != none) {
            of.named[--of.begin[faces.indices[c]]] = filed.normal_of[c];
        }
    }
    return of;
}

std::size_t without(const std::vector<std::uint32_t>& named)
{
    return static_cast<std::size_t>(std::count(named.begin(), named.end(), none));
}

}  // namespace

Mesh with_uvs(Mesh mesh, const ObjCorners& filed)
{
    if (filed.uv_of.empty()) {
        if (!filed.uvs.empty()) {
            mesh.notes.push_back(std::to_string(filed.uvs.size()) +
                                 " vt lines are used by no face");
        }
        return mesh;
    }
    const std::vector<std::uint32_t>& vertex = mesh.faces.indices;
    std::vector<std::uint32_t> first(mesh.positions.size(), none);
    bool agree = true;
    for (std::size_t c = 0; c < vertex.size() && agree; ++c) {
        const std::uint32_t uv = filed.uv_of[c];
        if (uv == none) { continue; }
        std::uint32_t& known = first[vertex[c]];
        if (known == none) { known = uv; }
        agree = known == uv || filed.uvs[known] == filed.uvs[uv];
    }
    const auto uv_at = [&](std::uint32_t i) {
        return i == none ? std::array<float, 2>{} : filed.uvs[i];
    };
    std::vector<std::array<float, 2>>& uvs = agree ? mesh.uvs : mesh.corner_uvs;
    const std::vector<std::uint32_t>& source = agree ? first : filed.uv_of;
    uvs.resize(source.size());
    std::transform(source.begin(), source.end(), uvs.begin(), uv_at);
    if (const std::size_t corners = without(filed.uv_of); corners > 0) {
        mesh.notes.push_back(std::to_string(corners) +
                             " face corners name no vt while others do: (0, 0) unless another "
                             "corner of the vertex names one");
    }
    return mesh;
}

Mesh with_normals(Mesh mesh, const ObjCorners& filed)
{
    if (filed.normal_of.empty()) {
        if (mesh.faces.count() == 0 && filed.normals.size() == mesh.positions.size()) {
            mesh.normals = filed.normals;
        } else if (!filed.normals.empty()) {
            mesh.notes.push_back(std::to_string(filed.normals.size()) +
                                 " vn lines are used by no face");
        }
        return mesh;
    }
    const std::vector<std::uint32_t>& vertex = mesh.faces.indices;
    std::vector<std::uint32_t> first(mesh.positions.size(), none);
    std::vector<bool> differ(mesh.positions.size());
    for (std::size_t c = 0; c < vertex.size(); ++c) {
        const std::uint32_t n = filed.normal_of[c];
        if (n == none) { continue; }
        std::uint32_t& known = first[vertex[c]];
        if (known == none) { known = n; }
        if (known != n && filed.normals[known] != filed.normals[n]) { differ[vertex[c]] = true; }
    }
    mesh.normals.resize(mesh.positions.size());
    for (std::size_t v = 0; v < first.size(); ++v) {
        if (first[v] != none) { mesh.normals[v] = filed.normals[first[v]]; }
    }
    const auto several = std::count(differ.begin(), differ.end(), true);
    if (several == 0) { return mesh; }
    NormalsOfVertices of = gather(mesh.faces, mesh.positions.size(), filed);
    for (std::size_t v = 0; v < differ.size(); ++v) {
        if (!differ[v]) { continue; }
        mesh.normals[v] = merged(
            std::span(of.named).subspan(of.begin[v], of.begin[v + 1] - of.begin[v]), filed.normals);
    }
    mesh.notes.push_back(std::to_string(several) +
                         " vertices have several normals (hard edges): each is lit by the "
                         "normalised sum of its distinct ones");
    return mesh;
}

}  // namespace relight
