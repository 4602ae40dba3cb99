#include "core/geometry/refine.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "core/geometry/copied.h"
#include "core/geometry/halves.h"
#include "core/geometry/polygon.h"

namespace relight {
namespace {

using namespace halves;

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
