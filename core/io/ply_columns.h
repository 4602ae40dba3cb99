#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "core/io/ply_header.h"
#include "core/io/writers.h"

namespace relight::ply {

/// Properties of one type that lie beside each other in a vertex record.
struct Column {
    Scalar type{};
    std::vector<std::string> names;
    /// Writes vertices [first, first + n) at `out`, `out` + stride, ...
    std::function<void(std::size_t first, std::size_t n, char* out, std::size_t stride)> fill;

    std::size_t size() const { return names.size() * size_of(type); }
};

/// Everything of a vertex that is written, in the order of the record. Refers to the mesh and the
/// spans of `lit`.
std::vector<Column> columns_of(const LitMesh& lit);

}  // namespace relight::ply
