#include "core/geometry/refine.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <tuple>

#include "core/geometry/copied.h"
#include "core/geometry/filled.h"
#include "core/geometry/polygon.h"

namespace relight {
namespace {

constexpr std::uint32_t none = 0xFFFFFFFF;
constexpr std::size_t block = 4096;  // triangles or edges between two looks at Progress

struct Stopped {};

void look(const Progress& progress)
{
    if (progress.stopped()) { throw Stopped{}; }
}

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

/// The mesh with its polygons in triangles, as prepare() splits them.
Mesh triangulated(const Mesh& mesh, const Progress& progress)
{
    Mesh out = copied_without_faces(mesh, progress);
    if (mesh.faces.offsets.empty()) {
        copy_faces(mesh, out, progress);
        return out;
    }
    const std::size_t faces = mesh.faces.indices.size() - 2 * mesh.faces.count();
    out.faces.indices.reserve(3 * faces);
    out.corner_uvs.reserve(mesh.corner_uvs.empty() ? 0 : 3 * faces);
    out.face_materials.reserve(mesh.face_materials.empty() ? 0 : faces);
    std::vector<Point3> polygon;
    std::vector<unsigned> corners;  // 0, 1, 2 … of the polygon: tell apart those of one vertex
    std::vector<Triangle> triangles;
    for (std::size_t f = 0; f < mesh.faces.count(); ++f) {
        look(progress);
        const std::size_t begin = mesh.faces.begin(f);
        polygon.clear();
        corners.clear();
        triangles.clear();
        for (std::size_t c = begin; c < mesh.faces.end(f); ++c) {
            corners.push_back(static_cast<unsigned>(c - begin));
            polygon.push_back(mesh.positions[mesh.faces.indices[c]]);
        }
        triangulate(polygon, corners, triangles);
        for (const Triangle& triangle : triangles) {
            for (const unsigned k : triangle) {
                out.faces.indices.push_back(mesh.faces.indices[begin + k]);
                if (!mesh.corner_uvs.empty()) {
                    out.corner_uvs.push_back(mesh.corner_uvs[begin + k]);
                }
            }
            if (!mesh.face_materials.empty()) {
                out.face_materials.push_back(mesh.face_materials[f]);
            }
        }
    }
    return out;
}

/// The corner after `corner` in its triangle.
std::size_t next(std::size_t corner)
{
    return corner % 3 == 2 ? corner - 2 : corner + 1;
}

/// Of the edge from this corner to the next. The same number from either side: the squares of
/// a - b and b - a are.
double edge_length(const Mesh& mesh, std::size_t corner)
{
    const std::vector<std::uint32_t>& indices = mesh.faces.indices;
    return length(mesh.positions[indices[corner]] - mesh.positions[indices[next(corner)]]);
}

/// An edge to be halved, as the triangle sees it that has `corner` at its begin.
struct LongEdge {
    std::uint32_t a, b;  // its vertices, a < b
    std::uint32_t corner;

    bool same_as(const LongEdge& other) const { return a == other.a && b == other.b; }
};

/// Sorted by vertices, so that all triangles at an edge stand together, however many they are.
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

/// Halves these edges and fits their triangles in.
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

/// Triangles that it takes at least: an edge of length L is that of L / max_edge of them, and none
/// has more area than the equilateral one. Cut at the largest number there is.
std::uint64_t least_faces(const Mesh& mesh, double max_edge, const Progress& progress)
{
    const double largest_area = 0.25 * std::sqrt(3.0) * max_edge * max_edge;
    double least = 0.0;
    for (std::size_t c = 0; c + 2 < mesh.faces.indices.size(); c += 3) {
        if (c % block == 0) { look(progress); }
        const auto corner = [&](std::size_t k) {
            return mesh.positions[mesh.faces.indices[c + k]];
        };
        const double area = 0.5 * length(cross(corner(1) - corner(0), corner(2) - corner(0)));
        const double longest =
            std::max({edge_length(mesh, c), edge_length(mesh, c + 1), edge_length(mesh, c + 2)});
        constexpr double rounding = 1.0 - 1e-9;
        least += std::max({1.0, rounding * (area / largest_area), rounding * (longest / max_edge)});
    }
    constexpr double most = 1e18;
    return static_cast<std::uint64_t>(least < most ? least : most);
}

/// A round shortens the longest edge L to max(h, sqrt(3)/2 L), h the longest that may stay. Halves
/// are L/2. A triangle with one edge halved gets the median to it, at most the mean of the two
/// other edges, which are h or less. One with two gets half its third edge c <= h, and the shorter
/// diagonal: the median to the longer a of the halved edges, squared (2 c^2 + 2 b^2 - a^2) / 4 <=
/// (2 c^2 + b^2) / 4 <= (2 h^2 + L^2) / 4 < 3/4 L^2, is no shorter. One with three gets halves.
/// Two more rounds: for rounding.
int most_rounds(double longest, double max_edge)
{
    const double ratio = std::min(longest / max_edge, std::numeric_limits<double>::max());
    return static_cast<int>(std::ceil(std::log(ratio) / std::log(2.0 / std::sqrt(3.0)))) + 2;
}

std::string shown(double number)
{
    std::array<char, 32> digits;
    return {digits.data(), std::to_chars(digits.data(), digits.data() + 32, number).ptr};
}

std::optional<Error> too_many(Fault fault, std::uint64_t count, const std::string& what,
                              std::uint64_t most, double max_edge)
{
    if (count <= most) { return {}; }
    return Error{fault,
                 "edges no longer than " + shown(max_edge) + " take " + std::to_string(count) +
                     " " + what + " or more; the limit is " + std::to_string(most) +
                     ": raise max_edge",
                 {},
                 {},
                 {}};
}

/// refine(), which throws Stopped.
Result<Mesh> refined(const Mesh& mesh, double max_edge, std::uint64_t most_vertices,
                     std::uint64_t most_faces, const Progress& progress)
{
    most_vertices = std::min<std::uint64_t>(most_vertices, none);
    most_faces = std::min<std::uint64_t>(most_faces, none / 3);
    Mesh out = triangulated(mesh, progress);
    look(progress);
    double longest = 0.0;
    for (std::size_t c = 0; c < out.faces.indices.size(); ++c) {
        if (c % block == 0) { look(progress); }
        longest = std::max(longest, edge_length(out, c));
    }
    if (!(longest > max_edge)) {
        copy_faces(mesh, out, progress);  // its polygons again
        look(progress);
        return out;
    }
    out.pieces.clear();  // new vertices belong to none
    if (auto error = too_many(Fault::TooManyFaces, least_faces(out, max_edge, progress), "faces",
                              most_faces, max_edge)) {
        return std::move(*error);
    }

    int rounds = 0;
    for (const int most = most_rounds(longest, max_edge); rounds < most; ++rounds) {
        const std::vector<LongEdge> edges = long_edges(out, max_edge, progress);
        look(progress);
        if (edges.empty()) { break; }
        std::uint64_t middles = 1;
        for (std::size_t e = 1; e < edges.size(); ++e) {
            if (e % block == 0) { look(progress); }
            middles += edges[e].same_as(edges[e - 1]) ? 0 : 1;
        }
        if (auto error = too_many(Fault::TooManyVertices, out.positions.size() + middles,
                                  "vertices", most_vertices, max_edge)) {
            return std::move(*error);
        }
        if (auto error = too_many(Fault::TooManyFaces, out.faces.count() + edges.size(), "faces",
                                  most_faces, max_edge)) {
            return std::move(*error);
        }
        reserve_vertices(out, out.positions.size() + middles, progress);
        look(progress);
        halve(out, edges, progress);
    }
    out.notes.push_back("refined: edges longer than " + shown(max_edge) + " were halved in " +
                        std::to_string(rounds) + " rounds; " +
                        std::to_string(mesh.positions.size()) + " vertices became " +
                        std::to_string(out.positions.size()) + ", " +
                        std::to_string(mesh.faces.count()) + " faces " +
                        std::to_string(out.faces.count()) + " triangles");
    return out;
}

}  // namespace

Result<Mesh> refine(const Mesh& mesh, double max_edge, std::uint64_t most_vertices,
                    std::uint64_t most_faces, Progress& progress)
{
    try {
        return refined(mesh, max_edge, most_vertices, most_faces, progress);
    } catch (const Stopped&) {
        return Error{Fault::Cancelled, "refining was stopped", {}, {}, {}};
    }
}

}  // namespace relight
