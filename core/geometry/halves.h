#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/base/progress.h"
#include "core/geometry/mesh.h"

/// One round of refine(): which edges of triangles are too long, and each of them halved. Both are
/// for meshes of triangles alone, and throw Stopped.
namespace relight::halves {

constexpr std::uint32_t none = 0xFFFFFFFF;
constexpr std::size_t block = 4096;  ///< triangles or edges between two looks at Progress

struct Stopped {};

inline void look(const Progress& progress)
{
    if (progress.stopped()) { throw Stopped{}; }
}

/// Of the edge from this corner to the next of its triangle. The same number from either side: the
/// squares of a - b and b - a are.
double edge_length(const Mesh& mesh, std::size_t corner);

/// An edge to be halved, as the triangle sees it that has `corner` at its begin.
struct LongEdge {
    std::uint32_t a, b;  // its vertices, a < b
    std::uint32_t corner;

    bool same_as(const LongEdge& other) const { return a == other.a && b == other.b; }
};

/// Those longer than max_edge, sorted by vertices, so that all triangles at an edge stand together,
/// however many they are.
std::vector<LongEdge> long_edges(const Mesh& mesh, double max_edge, const Progress& progress);

/// Halves these edges and fits their triangles in.
void halve(Mesh& mesh, const std::vector<LongEdge>& edges, const Progress& progress);

}  // namespace relight::halves
