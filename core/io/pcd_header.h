#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "core/geometry/mesh.h"

namespace relight::pcd {

enum class Encoding { Ascii, Binary, Compressed };

/// A field of a point. The name points into the file.
struct Field {
    std::string_view name;
    char type = 'F';           ///< 'I', 'U' or 'F'
    std::size_t size = 4;      ///< of one number [byte]
    std::uint64_t count = 1;   ///< numbers
    std::uint64_t offset = 0;  ///< bytes before it in a point
    std::uint64_t column = 0;  ///< numbers before it in a point
};

struct Header {
    Encoding encoding{};
    std::vector<Field> fields;
    std::uint64_t points = 0;
    std::uint64_t stride = 0, columns = 0;  ///< bytes, numbers of a point
    std::optional<Point3> viewpoint;        ///< the translation of VIEWPOINT
    std::size_t body = 0;                   ///< where the points start [byte]
    std::uint64_t body_line = 0;            ///< and on which line
};

/// Longest header read.
inline constexpr std::size_t longest_header = std::size_t{1} << 20;

/// The header of a PCD file up to its DATA line. The points it announces fit into memory as
/// numbers, but whether the file holds them is yet to be seen. Errors: MalformedHeader,
/// CountExceedsFile, NoGeometry, and those of parse_coordinate for VIEWPOINT.
Result<Header> read_header(std::span<const std::byte> file);

}  // namespace relight::pcd
