#include "core/geometry/surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/geometry/cloud_normals.h"
#include "core/geometry/normal_map.h"
#include "core/geometry/polygon.h"
#include "core/geometry/spacing.h"
#include "core/geometry/tangents.h"

namespace relight {
namespace {

Bounds bounds_of(const std::vector<Point3>& positions)
{
    if (positions.empty()) { return {}; }
    Bounds b{positions[0], positions[0]};
    for (const Point3 p : positions) {
        b.min = {std::min(b.min.x, p.x), std::min(b.min.y, p.y), std::min(b.min.z, p.z)};
        b.max = {std::max(b.max.x, p.x), std::max(b.max.y, p.y), std::max(b.max.z, p.z)};
    }
    return b;
}

/// Distance between neighbouring numbers at the largest coordinate, in the precision that was
/// filed.
double quantum_of(const Mesh& mesh, const Bounds& b)
{
    const double largest = std::max({std::abs(b.min.x), std::abs(b.min.y), std::abs(b.min.z),
                                     std::abs(b.max.x), std::abs(b.max.y), std::abs(b.max.z)});
    if (mesh.double_positions) {
        return std::nextafter(largest, std::numeric_limits<double>::infinity()) - largest;
    }
    const auto as_float = static_cast<float>(largest);
    return std::nextafter(as_float, std::numeric_limits<float>::infinity()) -
           static_cast<double>(as_float);
}

void triangulate_faces(const Mesh& mesh, Surface& surface)
{
    const Faces& faces = mesh.faces;
    if (faces.offsets.empty()) {
        surface.triangles.resize(faces.count());
        for (std::size_t f = 0; f < surface.triangles.size(); ++f) {
            surface.triangles[f] = {faces.indices[3 * f], faces.indices[3 * f + 1],
                                    faces.indices[3 * f + 2]};
        }
        return;
    }
    std::uint64_t fans = 0;
    const std::size_t triangles = faces.indices.size() - 2 * faces.count();
    surface.triangles.reserve(triangles);
    surface.triangle_face.reserve(triangles);
    for (std::size_t f = 0; f < faces.count(); ++f) {
        const std::span corners(faces.indices.data() + faces.begin(f),
                                faces.end(f) - faces.begin(f));
        if (!triangulate(mesh.positions, corners, surface.triangles)) { ++fans; }
        surface.intake.polygons_triangulated += corners.size() > 3 ? 1 : 0;
        surface.triangle_face.resize(surface.triangles.size(), static_cast<std::uint32_t>(f));
    }
    if (fans > 0) {
        surface.intake.notes.push_back(std::to_string(fans) + " concave polygons of more than " +
                                       std::to_string(most_corners_clipped) +
                                       " corners were split as fans");
    }
}

/// Surface::vertex_groups.
std::vector<std::uint32_t> vertex_groups_of(const Mesh& mesh)
{
    if (mesh.maps.empty() || mesh.face_materials.empty()) { return {}; }
    std::vector<std::uint32_t> groups(mesh.positions.size(), no_group);
    for (std::size_t face = 0; face < mesh.faces.count(); ++face) {
        for (std::size_t c = mesh.faces.begin(face); c < mesh.faces.end(face); ++c) {
            std::uint32_t& group = groups[mesh.faces.indices[c]];
            if (group == no_group) { group = mesh.face_materials[face]; }
        }
    }
    return groups;
}

/// Angle-weighted normals (Thürmer and Wüthrich 1998), shortest edges, and which vertices are used:
/// one pass over the triangles in their order.
struct FromFaces {
    std::vector<Vec3> normals;
    std::vector<float> shortest_edge;
    std::vector<std::uint8_t> used;
};

/// A sphere's worth of volume for a surface of this area is 1 (isoperimetric quotient); a room open
/// on one side or a scan with holes keeps most of it, a sheet has none.
constexpr double least_enclosed = 0.01;

FromFaces walk_faces(const Mesh& mesh, Surface& surface)
{
    const std::size_t count = mesh.positions.size();
    FromFaces walked{std::vector<Vec3>(count),
                     std::vector<float>(count, std::numeric_limits<float>::infinity()),
                     std::vector<std::uint8_t>(count, 0)};
    const Point3 centre = surface.bounds.centre();
    double volume6 = 0.0;
    double area2 = 0.0;
    for (const Triangle& t : surface.triangles) {
        for (const unsigned v : t) { walked.used[v] = 1; }
        const std::array<Point3, 3> p{mesh.positions[t[0]], mesh.positions[t[1]],
                                      mesh.positions[t[2]]};
        const std::array<Vec3, 3> edge{p[1] - p[0], p[2] - p[1], p[0] - p[2]};
        const Vec3 doubled_area = cross(edge[0], -edge[2]);
        const std::array<double, 3> squared{dot(edge[0], edge[0]), dot(edge[1], edge[1]),
                                            dot(edge[2], edge[2])};
        const double longest = std::max({squared[0], squared[1], squared[2]});
        const double area = std::sqrt(dot(doubled_area, doubled_area));
        if (!(area > 1e-14 * longest)) {  // collinear to within rounding: no side to be lit
            ++surface.intake.degenerate_faces;
            continue;
        }
        volume6 += dot(p[0] - centre, doubled_area);
        area2 += area;
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t before = (k + 2) % 3;
            const double angle = std::atan2(area, -dot(edge[k], edge[before]));
            walked.normals[t[k]] += doubled_area * (angle / area);
            const auto shorter =
                static_cast<float>(std::sqrt(std::min(squared[k], squared[before])));
            walked.shortest_edge[t[k]] = std::min(walked.shortest_edge[t[k]], shorter);
        }
    }
    // 36 pi V^2 / A^3 = 8 pi V6^2 / A2^3
    const double enclosed = 8.0 * std::numbers::pi * volume6 * volume6 / (area2 * area2 * area2);
    surface.intake.wound_inward = volume6 < 0.0 && enclosed > least_enclosed;
    return walked;
}

}  // namespace

Surface prepare(const Mesh& mesh, unsigned threads, Progress& progress,
                const CloudNormals& cloud_normals)
{
    Surface surface;
    surface.bounds = bounds_of(mesh.positions);
    surface.quantum = quantum_of(mesh, surface.bounds);
    surface.intake.recentring_shift = surface.bounds.centre() - Point3{};
    surface.intake.notes = mesh.notes;
    triangulate_faces(mesh, surface);

    const std::size_t count = mesh.positions.size();
    const bool cloud = surface.triangles.empty();
    FromFaces faces = walk_faces(mesh, surface);
    const bool estimate = cloud && (cloud_normals.estimate || mesh.normals.empty());
    std::vector<Dir3> estimated;
    Neighbours neighbours;
    if (cloud) {
        neighbours = neighbours_of(mesh.positions, mesh.absent, threads, progress);
        surface.spacing = cloud_spacing(mesh.positions, neighbours, threads, progress);
        if (estimate) {
            estimated = estimate_normals(mesh.positions, neighbours, surface.spacing,
                                         cloud_normals.toward, threads, progress);
        }
    }
    surface.intake.absent_points = mesh.absent.size();
    surface.normals.resize(count);
    for (std::size_t v = 0; v < count; ++v) {
        const Dir3 filed = estimate || mesh.normals.empty() ? Dir3() : normalize(mesh.normals[v]);
        const Dir3 computed = estimate ? estimated[v] : normalize(faces.normals[v]);
        surface.normals[v] = filed ? filed : computed;
        if (estimate && computed) { ++surface.intake.normals_estimated; }
        if (!estimate && !filed && computed) { ++surface.intake.normals_computed; }
        if (filed && dot(filed, faces.normals[v]) < 0.0) { ++surface.intake.normals_opposing; }
        if (!surface.normals[v]) { ++surface.intake.unlit_vertices; }
        if (!cloud && faces.used[v] == 0) { ++surface.intake.unreferenced_vertices; }
        if (!std::isfinite(faces.shortest_edge[v])) { faces.shortest_edge[v] = 0.0F; }
    }
    for (const std::uint32_t v : mesh.absent) {
        if (surface.normals[v]) { ++surface.intake.unlit_vertices; }
        surface.normals[v] = {};
    }
    surface.vertex_groups = vertex_groups_of(mesh);
    surface.tangents = tangents_of(mesh, surface);
    apply_normal_maps(mesh, surface);
    if (cloud) {
        surface.bend = cloud_bend(surface.normals, neighbours, threads, progress);
    } else {
        surface.spacing = std::move(faces.shortest_edge);
    }
    return surface;
}

}  // namespace relight
