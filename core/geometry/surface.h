#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/result.h"
#include "core/geometry/mesh.h"
#include "core/geometry/vertex_fields.h"

namespace relight {

/// What loading found and did. Nothing is changed silently.
struct Intake {
    std::uint64_t degenerate_faces = 0;    ///< a repeated corner, or no area
    std::uint64_t duplicate_faces = 0;     ///< the same vertices as an earlier face
    std::uint64_t non_manifold_edges = 0;  ///< shared by more than two faces
    std::uint64_t boundary_edges = 0;      ///< of one face only
    std::uint64_t inconsistent_edges =
        0;  ///< whose two faces run the same way: no common orientation
    std::uint64_t unreferenced_vertices = 0;  ///< used by no face
    std::uint64_t unlit_vertices = 0;  ///< without a normal: used by no proper face, and none filed
    std::uint64_t normals_computed = 0;   ///< vertices whose normal comes from the faces
    std::uint64_t normals_estimated = 0;  ///< points whose normal comes from their neighbours
    std::uint64_t absent_points = 0;      ///< places without a point (NaN in the file)
    std::uint64_t normals_opposing = 0;   ///< filed normals that point to the back of their faces
    std::uint64_t polygons_triangulated = 0;  ///< faces with more than three corners
    bool wound_inward = false;       ///< the faces enclose a volume and their fronts look into it
    Vec3 recentring_shift;           ///< subtracted before the acceleration structure is built
    std::vector<std::string> notes;  ///< the reader's own
};

struct Bounds {
    Point3 min, max;

    void add(Point3 p)
    {
        min = {std::min(min.x, p.x), std::min(min.y, p.y), std::min(min.z, p.z)};
        max = {std::max(max.x, p.x), std::max(max.y, p.y), std::max(max.z, p.z)};
    }
    Point3 centre() const { return min + (max - min) * 0.5; }
    double diagonal() const { return length(max - min); }
};

/// A vertex of no group of faces.
inline constexpr std::uint32_t no_group = ~0U;

/// A mesh made ready for light: normals, triangles, the size of things. A point cloud is a Surface
/// without triangles.
struct Surface {
    std::vector<Triangle> triangles;           ///< of the faces, in their order; empty for clouds
    std::vector<std::uint32_t> triangle_face;  ///< face of each triangle; empty: the same index
    std::vector<Dir3> normals;                 ///< V; "no direction": the vertex cannot be lit
    /// V unit tangents along increasing u of the texture coordinates, perpendicular to the (smooth)
    /// normal, and the sign of the bitangent; empty: the mesh has none. A zero one: none here.
    std::vector<std::array<float, 4>> tangents;
    /// V, into Mesh::maps: of the first face that uses the vertex; no_group: none does. Empty: the
    /// mesh has no maps.
    std::vector<std::uint32_t> vertex_groups;
    /// V normals before the mesh's normal maps bent them; empty: none did. Between vertices, these
    /// are interpolated and bent anew.
    std::vector<Dir3> smooth_normals;
    std::vector<float> spacing;  ///< V, scene units: shortest edge at the vertex; in a cloud,
                                 ///< 1/sqrt(points per area) around it
    /// V, clouds only: sine of twice the angle by which the normals turn from a point to its
    /// neighbours (1: a right angle or more). So far beyond a silhouette its disc may show.
    std::vector<float> bend;
    /// V: every vertex once, along a Morton curve (morton.h): near in space, near in the order.
    /// Work that looks around each vertex goes in this order, whatever the file's.
    std::vector<std::uint32_t> order;
    VertexFields ordered;  ///< in that order
    Bounds bounds;
    double quantum = 0.0;  ///< coarsest step of the coordinates as filed, scene units
    Intake intake;
};

/// Frame to shade a vertex in: z its normal, x its tangent; without one, frame_around(normal).
Frame shading_frame(const Surface& surface, std::size_t vertex);

/// The whole report: what prepare() counted, and the topology of the faces as filed (duplicate
/// faces; non-manifold, boundary and inconsistently wound edges), by OpenMesh's half-edge
/// structure. Costs more than prepare(): asked for once, when a mesh is stored.
/// @param progress of no use once it is stopped
Intake inspect(const Mesh& mesh, const Surface& surface, Progress& progress);
Intake inspect(const Mesh& mesh, const Surface& surface);

/// How the normals of a cloud come about.
struct CloudNormals {
    bool estimate = false;         ///< even if the file brings some
    std::optional<Point3> toward;  ///< they face this place; absent: see estimate_normals
};

/// Normals (filed ones kept, else angle-weighted from the faces, else of a cloud estimated),
/// triangulation (ear clipping for concave polygons), spacing, and the intake report. Never fails
/// on a checked Mesh; a degenerate one gives unlit vertices and says so.
Surface prepare(const Mesh& mesh, unsigned threads, Progress& progress,
                const CloudNormals& cloud_normals = {});

}  // namespace relight
