#include "core/geometry/halves.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "core/geometry/filled.h"

namespace relight::halves {
namespace {

/// Halfway, of numbers whose sum a float may not hold.
template <std::size_t N>
std::array<float, N> mean(const std::array<float, N>& a, const std::array<float, N>& b)
{
    std::array<float, N> out;
    for (std::size_t k = 0; k < N; ++k) { out[k] = 0.5F * a[k] + 0.5F * b[k]; }
    return out;
}

/// Halfway between two filed directions; where one is missing, the other.
Dir3 mean_direction(Vec3 a, Vec3 b)
{
    return normalize(Vec3(normalize(a)) + Vec3(normalize(b)));
}

std::array<float, 4> mean_tangent(const std::array<float, 4>& a, const std::array<float, 4>& b)
{
    const Vec3 u{a[0], a[1], a[2]};
    const Dir3 middle = mean_direction(u, {b[0], b[1], b[2]});
    const Rgbf t = to_float(Rgb{middle.x(), middle.y(), middle.z()});
    return {t[0], t[1], t[2], u == Vec3{} ? b[3] : a[3]};
}

/// The same from either end, so that edges that meet without sharing vertices (of STL, at seams)
/// still meet.
Point3 mean_place(Point3 p, Point3 q)
{
    return {0.5 * (p.x + q.x), 0.5 * (p.y + q.y), 0.5 * (p.z + q.z)};
}

/// Adds the vertex in the middle of the edge from a to b.
void append_middle(Mesh& mesh, std::uint32_t a, std::uint32_t b)
{
    const auto append = [&](auto& values, auto middle) {
        if (!values.empty()) { values.push_back(middle(values[a], values[b])); }
    };
    const auto as_numbers = [](const auto& x, const auto& y) { return mean(x, y); };
    append(mesh.positions, mean_place);
    append(mesh.normals, mean_direction);
    append(mesh.colors, as_numbers);
    append(mesh.uvs, as_numbers);
    append(mesh.uvs_1, as_numbers);
    append(mesh.tangents, mean_tangent);
}

/// The corner after `corner` in its triangle.
std::size_t next(std::size_t corner)
{
    return corner % 3 == 2 ? corner - 2 : corner + 1;
}

struct Corner {
    std::uint32_t vertex = none;
    Uv uv{};  // of Mesh::corner_uvs
};

/// Puts 1, 2, 3 or 4 triangles in the place of one. m[k] is the middle between c[k] and the corner
/// after it, none where that edge stays whole.
template <class Emit>
void split(const Mesh& mesh, const std::array<Corner, 3>& c, const std::array<Corner, 3>& m,
           Emit emit)
{
    const auto halved = [&](std::size_t k) { return m[k % 3].vertex != none; };
    const int count = (halved(0) ? 1 : 0) + (halved(1) ? 1 : 0) + (halved(2) ? 1 : 0);
    if (count == 0) { return emit(c[0], c[1], c[2]); }
    if (count == 3) {
        for (std::size_t k = 0; k < 3; ++k) { emit(c[k], m[k], m[(k + 2) % 3]); }
        return emit(m[0], m[1], m[2]);
    }
    std::size_t k = 0;  // the edge unlike the other two
    while (halved(k) != (count == 1)) { ++k; }
    const Corner &begin = c[k], &end = c[(k + 1) % 3], &top = c[(k + 2) % 3];
    if (count == 1) {
        emit(begin, m[k], top);
        return emit(m[k], end, top);
    }
    const Corner &right = m[(k + 1) % 3], &left = m[(k + 2) % 3];
    const auto squared = [&](const Corner& x, const Corner& y) {
        const Vec3 d = mesh.positions[x.vertex] - mesh.positions[y.vertex];
        return dot(d, d);
    };
    emit(left, right, top);
    if (squared(begin, right) <= squared(end, left)) {
        emit(begin, end, right);
        return emit(begin, right, left);
    }
    emit(begin, end, left);
    emit(end, right, left);
}

}  // namespace

double edge_length(const Mesh& mesh, std::size_t corner)
{
    const std::vector<std::uint32_t>& indices = mesh.faces.indices;
    return length(mesh.positions[indices[corner]] - mesh.positions[indices[next(corner)]]);
}

std::vector<LongEdge> long_edges(const Mesh& mesh, double max_edge, const Progress& progress)
{
    const std::vector<std::uint32_t>& indices = mesh.faces.indices;
    const auto each = [&](const auto& take) {
        for (std::size_t c = 0; c < indices.size(); ++c) {
            if (c % block == 0) { look(progress); }
            if (edge_length(mesh, c) > max_edge) { take(c); }
        }
    };
    std::size_t count = 0;
    each([&](std::size_t /*corner*/) { ++count; });
    std::vector<LongEdge> edges;
    edges.reserve(count);
    each([&](std::size_t c) {
        const auto [a, b] = std::minmax(indices[c], indices[next(c)]);
        edges.push_back({a, b, static_cast<std::uint32_t>(c)});
    });
    std::sort(edges.begin(), edges.end(), [&](const LongEdge& x, const LongEdge& y) {
        look(progress);
        return std::tie(x.a, x.b, x.corner) < std::tie(y.a, y.b, y.corner);
    });
    return edges;
}

void halve(Mesh& mesh, const std::vector<LongEdge>& edges, const Progress& progress)
{
    const Faces before = std::move(mesh.faces);
    const std::vector<Uv> uvs = std::move(mesh.corner_uvs);
    const std::vector<std::uint32_t> materials = std::move(mesh.face_materials);
    mesh.faces = {};
    mesh.corner_uvs.clear();
    mesh.face_materials.clear();

    auto middles = filled(before.indices.size(), progress, none);  // by corner
    for (std::size_t e = 0; e < edges.size(); ++e) {
        if (e % block == 0) { look(progress); }
        if (e == 0 || !edges[e].same_as(edges[e - 1])) {
            append_middle(mesh, edges[e].a, edges[e].b);
        }
        middles[edges[e].corner] = static_cast<std::uint32_t>(mesh.positions.size() - 1);
    }
    const std::size_t faces = before.count() + edges.size();  // one more for each edge of each
    mesh.faces.indices.reserve(3 * faces);
    mesh.corner_uvs.reserve(uvs.empty() ? 0 : 3 * faces);
    mesh.face_materials.reserve(materials.empty() ? 0 : faces);
    for (std::size_t f = 0; f < before.count(); ++f) {
        if (f % block == 0) { look(progress); }
        std::array<Corner, 3> corners, halves;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t c = 3 * f + k;
            corners[k].vertex = before.indices[c];
            halves[k].vertex = middles[c];
            if (uvs.empty()) { continue; }
            corners[k].uv = uvs[c];
            halves[k].uv = mean(uvs[c], uvs[next(c)]);
        }
        split(mesh, corners, halves, [&](const Corner& a, const Corner& b, const Corner& c) {
            for (const Corner& corner : {a, b, c}) {
                mesh.faces.indices.push_back(corner.vertex);
                if (!uvs.empty()) { mesh.corner_uvs.push_back(corner.uv); }
            }
            if (!materials.empty()) { mesh.face_materials.push_back(materials[f]); }
        });
    }
}

}  // namespace relight::halves
