#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>

#include "core/geometry/filled.h"
#include "core/geometry/radix.h"
#include "core/geometry/surface.h"

namespace relight {
namespace {

using HalfEdges = OpenMesh::PolyMesh_ArrayKernelT<>;
using Handle = OpenMesh::VertexHandle;

Handle handle(std::uint32_t v)
{
    return Handle(static_cast<int>(v));
}

constexpr std::size_t block = 4096;  // faces between two looks at Progress

struct Stopped {};

/// How many faces run along an edge from its lower vertex to its higher one, and back.
struct Uses {
    std::uint64_t forward = 0, backward = 0;
};

/// A side of a face, as it runs.
struct Side {
    std::uint32_t from, to;

    bool forward() const { return from < to; }
    std::pair<std::uint32_t, std::uint32_t> edge() const { return std::minmax(from, to); }
};

/// Equal for faces over the same vertices in any order (splitmix64 over the sorted corners).
std::uint64_t face_key(const std::vector<std::uint32_t>& sorted)
{
    std::uint64_t key = sorted.size();
    for (const std::uint32_t v : sorted) {
        key = (key ^ v) + 0x9e3779b97f4a7c15ULL;
        key = (key ^ (key >> 30)) * 0xbf58476d1ce4e5b9ULL;
        key = (key ^ (key >> 27)) * 0x94d049bb133111ebULL;
        key ^= key >> 31;
    }
    return key;
}

/// How many of the keys have come before.
std::uint64_t repeated(std::vector<std::uint64_t> keys, Progress& progress)
{
    auto sorted = filled<std::uint64_t>(keys.size(), progress);
    sort_by_highest_30_bits(keys, sorted, 0, progress);
    std::uint64_t again = 0;
    for (std::size_t begin = 0, end = 0; begin < sorted.size(); begin = end) {
        if (progress.stopped()) { break; }
        const auto bits = [&](std::size_t i) { return sorted[i] >> 34; };
        while (end < sorted.size() && bits(end) == bits(begin)) { ++end; }
        const std::span alike(sorted.data() + begin, end - begin);
        std::sort(alike.begin(), alike.end());
        for (std::size_t i = 1; i < alike.size(); ++i) {
            again += alike[i] == alike[i - 1] ? 1 : 0;
        }
    }
    return again;
}

bool has_face(const HalfEdges& mesh, std::uint32_t from, std::uint32_t to)
{
    const auto h = mesh.find_halfedge(handle(from), handle(to));
    return h.is_valid() && mesh.face_handle(h).is_valid();
}

void classify(const Uses& uses, Intake& intake)
{
    const std::uint64_t faces = uses.forward + uses.backward;
    intake.non_manifold_edges += faces > 2 ? 1 : 0;
    intake.boundary_edges += faces == 1 ? 1 : 0;
    intake.inconsistent_edges += faces == 2 && uses.forward != 1 ? 1 : 0;
}

}  // namespace

Intake inspect(const Mesh& mesh, const Surface& surface)
{
    Progress never_stopped;
    return inspect(mesh, surface, never_stopped);
}

Intake inspect(const Mesh& mesh, const Surface& surface, Progress& progress)
{
    Intake intake = surface.intake;
    if (mesh.faces.count() == 0) { return intake; }
    omerr().disable();  // it reports each face it cannot link; we count them instead

    HalfEdges linked;
    linked.reserve(mesh.positions.size(), mesh.faces.indices.size() / 2 + 1, mesh.faces.count());
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
        if (v % block == 0 && progress.stopped()) { return intake; }
        linked.add_vertex({});
    }

    std::vector<Side> refused;  // of faces that a half-edge structure cannot hold
    std::vector<std::uint64_t> keys;
    keys.reserve(mesh.faces.count());
    std::vector<std::uint32_t> sorted;
    std::vector<Handle> corners;
    for (std::size_t f = 0; f < mesh.faces.count(); ++f) {
        if (f % block == 0 && progress.stopped()) { return intake; }
        const std::span face(mesh.faces.indices.data() + mesh.faces.begin(f),
                             mesh.faces.end(f) - mesh.faces.begin(f));
        sorted.assign(face.begin(), face.end());
        std::sort(sorted.begin(), sorted.end());
        keys.push_back(face_key(sorted));
        if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end()) { continue; }
        corners.clear();
        for (const std::uint32_t v : face) { corners.push_back(handle(v)); }
        if (linked.add_face(corners).is_valid()) { continue; }
        for (std::size_t k = 0; k < face.size(); ++k) {
            refused.push_back({face[k], face[(k + 1) % face.size()]});
        }
    }
    intake.duplicate_faces = repeated(std::move(keys), progress);

    try {
        std::sort(refused.begin(), refused.end(), [&](const Side& a, const Side& b) {
            if (progress.stopped()) { throw Stopped{}; }
            return a.edge() < b.edge();
        });
    } catch (const Stopped&) {
        return intake;
    }
    std::uint64_t boundary_touched = 0;  // half-edge boundaries that refused faces may have closed
    for (std::size_t begin = 0, end = 0; begin < refused.size(); begin = end) {
        const auto edge = refused[begin].edge();
        const bool forward = has_face(linked, edge.first, edge.second);
        const bool backward = has_face(linked, edge.second, edge.first);
        boundary_touched += forward != backward ? 1 : 0;
        Uses uses{forward ? 1U : 0U, backward ? 1U : 0U};
        for (; end < refused.size() && refused[end].edge() == edge; ++end) {
            ++(refused[end].forward() ? uses.forward : uses.backward);
        }
        classify(uses, intake);
    }
    std::uint64_t boundary = 0;
    std::size_t looked_at = 0;
    for (const auto edge : linked.edges()) {
        if (looked_at++ % block == 0 && progress.stopped()) { break; }
        boundary += linked.is_boundary(edge) ? 1 : 0;
    }
    intake.boundary_edges += boundary - boundary_touched;
    return intake;
}

}  // namespace relight
