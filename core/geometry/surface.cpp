#include "core/geometry/surface.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <span>

#include "core/geometry/cloud_normals.h"
#include "core/geometry/filled.h"
#include "core/geometry/from_faces.h"
#include "core/geometry/morton.h"
#include "core/geometry/normal_map.h"
#include "core/geometry/ordered_cloud.h"
#include "core/geometry/polygon.h"
#include "core/geometry/spacing.h"
#include "core/geometry/tangents.h"

namespace relight {
namespace {

constexpr std::size_t block = 16'384;  // vertices or faces between two looks at Progress

Bounds bounds_of(const std::vector<Point3>& positions, unsigned threads, Progress& progress)
{
    if (positions.empty()) { return {}; }
    Bounds whole{positions[0], positions[0]};
    std::vector<Bounds> parts((positions.size() + block - 1) / block, whole);
    parallel_for(positions.size(), block, threads, progress,
                 [&](std::size_t begin, std::size_t end) {
                     Bounds part = whole;
                     for (std::size_t i = begin; i < end; ++i) { part.add(positions[i]); }
                     parts[begin / block] = part;
                 });
    for (const Bounds& part : parts) {
        whole.add(part.min);
        whole.add(part.max);
    }
    return whole;
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

void triangulate_faces(const Mesh& mesh, unsigned threads, Progress& progress, Surface& surface)
{
    const Faces& faces = mesh.faces;
    if (faces.offsets.empty()) {
        surface.triangles = filled<Triangle>(faces.count(), progress);
        parallel_for(faces.count(), block, threads, progress,
                     [&](std::size_t begin, std::size_t end) {
                         for (std::size_t f = begin; f < end; ++f) {
                             surface.triangles[f] = {faces.indices[3 * f], faces.indices[3 * f + 1],
                                                     faces.indices[3 * f + 2]};
                         }
                     });
        return;
    }
    // A polygon of n corners gives n - 2 triangles: so it is known where they go.
    const auto first_of = [&](std::size_t f) { return faces.begin(f) - 2 * f; };
    const std::size_t triangles = faces.indices.size() - 2 * faces.count();
    surface.triangles = filled<Triangle>(triangles, progress);
    surface.triangle_face = filled<std::uint32_t>(triangles, progress);
    std::atomic<std::uint64_t> fans = 0, polygons = 0;
    constexpr std::size_t polygons_at_once = 64;  // each of up to `most_corners_clipped` corners
    parallel_for(faces.count(), polygons_at_once, threads, progress,
                 [&](std::size_t begin, std::size_t end) {
                     std::vector<Triangle> split;
                     for (std::size_t f = begin; f < end; ++f) {
                         const std::span corners(faces.indices.data() + faces.begin(f),
                                                 faces.end(f) - faces.begin(f));
                         split.clear();
                         if (!triangulate(mesh.positions, corners, split)) { ++fans; }
                         if (corners.size() > 3) { ++polygons; }
                         std::copy(split.begin(), split.end(), &surface.triangles[first_of(f)]);
                         std::fill_n(&surface.triangle_face[first_of(f)], split.size(),
                                     static_cast<std::uint32_t>(f));
                     }
                 });
    surface.intake.polygons_triangulated = polygons;
    if (fans > 0) {
        surface.intake.notes.push_back(std::to_string(fans) + " concave polygons of more than " +
                                       std::to_string(most_corners_clipped) +
                                       " corners were split as fans");
    }
}

/// Surface::vertex_groups.
std::vector<std::uint32_t> vertex_groups_of(const Mesh& mesh, const Progress& progress)
{
    if (mesh.maps.empty() || mesh.face_materials.empty()) { return {}; }
    auto groups = filled(mesh.positions.size(), progress, no_group);
    if (progress.stopped()) { return groups; }
    for (std::size_t face = 0; face < mesh.faces.count(); ++face) {
        if (face % block == 0 && progress.stopped()) { break; }
        for (std::size_t c = mesh.faces.begin(face); c < mesh.faces.end(face); ++c) {
            std::uint32_t& group = groups[mesh.faces.indices[c]];
            if (group == no_group) { group = mesh.face_materials[face]; }
        }
    }
    return groups;
}

/// The normals and spacing of a range of vertices, and what is to be counted of them. Estimated
/// normals stand where they belong already.
void settle(const Mesh& mesh, bool estimated, std::size_t first,
            std::span<const AtVertex> from_faces, Surface& surface, Intake& counts)
{
    const bool cloud = surface.triangles.empty();
    for (std::size_t v = first; v < first + from_faces.size(); ++v) {
        const auto& [normal, shortest2] = from_faces[v - first];
        const Dir3 filed = estimated || mesh.normals.empty() ? Dir3() : normalize(mesh.normals[v]);
        const Dir3 computed = estimated ? surface.normals[v] : normalize(normal);
        surface.normals[v] = filed ? filed : computed;
        if (!filed && computed) {
            ++(estimated ? counts.normals_estimated : counts.normals_computed);
        }
        if (filed && dot(filed, normal) < 0.0) { ++counts.normals_opposing; }
        if (!surface.normals[v]) { ++counts.unlit_vertices; }
        if (cloud) { continue; }
        if (shortest2 == AtVertex::unused) { ++counts.unreferenced_vertices; }
        surface.spacing[v] =
            shortest2 < AtVertex::degenerate ? static_cast<float>(std::sqrt(shortest2)) : 0.0F;
    }
}

}  // namespace

Surface prepare(const Mesh& mesh, unsigned threads, Progress& progress,
                const CloudNormals& cloud_normals)
{
    const std::size_t count = mesh.positions.size();
    Surface surface;
    Intake& intake = surface.intake;
    surface.bounds = bounds_of(mesh.positions, threads, progress);
    surface.quantum = quantum_of(mesh, surface.bounds);
    surface.order = morton_order(mesh.positions, surface.bounds, threads, progress);
    intake.recentring_shift = surface.bounds.centre() - Point3{};
    intake.notes = mesh.notes;
    intake.absent_points = mesh.absent.size();
    triangulate_faces(mesh, threads, progress, surface);
    if (progress.stopped()) { return surface; }

    const bool cloud = surface.triangles.empty();
    const bool estimated = cloud && (cloud_normals.estimate || mesh.normals.empty());
    OrderedCloud points;
    std::vector<float> spacing;
    std::vector<Dir3> normals;
    if (cloud) {
        points = ordered_cloud(mesh, surface.order, threads, progress);
        spacing = cloud_spacing(points.positions, points.neighbours, threads, progress);
    }
    if (estimated) {
        normals = estimate_normals(points.positions, points.neighbours, spacing,
                                   cloud_normals.toward, threads, progress);
    }
    surface.normals = filled<Dir3>(count, progress);
    surface.spacing = filled<float>(count, progress);
    if (cloud) { points.put(spacing, surface.spacing, threads, progress); }
    if (estimated) { points.put(normals, surface.normals, threads, progress); }
    const VertexRanges ranges(surface.triangles, count, threads, progress);
    std::mutex counting;
    const OfFaces faces =
        sum_faces(mesh.positions, surface.triangles, surface.bounds.centre(), ranges, progress,
                  [&](std::size_t first, std::span<const AtVertex> vertices) {
                      Intake counts;
                      settle(mesh, estimated, first, vertices, surface, counts);
                      const std::lock_guard lock(counting);
                      intake.normals_computed += counts.normals_computed;
                      intake.normals_estimated += counts.normals_estimated;
                      intake.normals_opposing += counts.normals_opposing;
                      intake.unlit_vertices += counts.unlit_vertices;
                      intake.unreferenced_vertices += counts.unreferenced_vertices;
                  });
    intake.degenerate_faces = faces.degenerate;
    intake.wound_inward = faces.wound_inward;
    if (progress.stopped()) { return surface; }
    for (const std::uint32_t v : mesh.absent) {
        if (surface.normals[v]) { ++intake.unlit_vertices; }
        surface.normals[v] = {};
    }
    surface.vertex_groups = vertex_groups_of(mesh, progress);
    surface.tangents = tangents_of(mesh, surface, ranges, progress);
    apply_normal_maps(mesh, threads, progress, surface);
    if (cloud) {
        const std::vector<float> bend = cloud_bend(points.taken(surface.normals, threads, progress),
                                                   points.neighbours, threads, progress);
        surface.bend = filled<float>(count, progress);
        points.put(bend, surface.bend, threads, progress);
    }
    surface.ordered = vertex_fields(mesh, surface, surface.order, threads, progress);
    return surface;
}

}  // namespace relight
