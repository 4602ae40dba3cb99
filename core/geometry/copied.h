#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/base/progress.h"
#include "core/geometry/mesh.h"

namespace relight {

/// A copy with room for `capacity` values; less of one if `progress` was stopped, which it asks
/// every few MiB.
template <class T>
std::vector<T> copied(const std::vector<T>& values, const Progress& progress,
                      std::size_t capacity = 0)
{
    constexpr std::size_t piece = (std::size_t{1} << 22) / sizeof(T);
    std::vector<T> copy;
    copy.reserve(std::max(capacity, values.size()));
    while (copy.size() < values.size() && !progress.stopped()) {
        const auto from = values.begin() + static_cast<std::ptrdiff_t>(copy.size());
        const std::size_t count = std::min(piece, values.size() - copy.size());
        copy.insert(copy.end(), from, from + static_cast<std::ptrdiff_t>(count));
    }
    return copy;
}

/// A mesh in pieces, of no use once `progress` is stopped: all but its faces and what it holds for
/// each corner and face.
Mesh copied_without_faces(const Mesh& mesh, const Progress& progress);

/// What copied_without_faces() leaves out.
void copy_faces(const Mesh& from, Mesh& to, const Progress& progress);

/// Makes room for so many vertices, and no more: vectors that grow by themselves double.
void reserve_vertices(Mesh& mesh, std::size_t vertices, const Progress& progress);

}  // namespace relight
