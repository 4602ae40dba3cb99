#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>

#include "core/base/result.h"
#include "core/geometry/mesh.h"
#include "core/io/text_scanner.h"

namespace relight {

/// Why `word`, which stands on `line`, is no coordinate. `expected` shows the form of the line.
Error coordinate_error(NumberKind kind, std::string_view word, std::string_view expected,
                       std::uint64_t line);

/// The number a word of a text file says, finite and of a magnitude up to largest_coordinate.
/// Errors: MalformedBody, NonFiniteCoordinate, CoordinateTooLarge, with the line.
inline Result<double> parse_coordinate(std::string_view word, std::string_view expected,
                                       std::uint64_t line)
{
    Number<double> number = parse_real(word);
    if (std::abs(number.value) > largest_coordinate) { number.kind = NumberKind::OutOfRange; }
    if (!number) { return coordinate_error(number.kind, word, expected, line); }
    return number.value;
}

/// True if `word`, which parse_real finds NonFinite, is one of the spellings of NaN.
bool says_nan(std::string_view word);

/// Why point `index` is no place, if so: infinite, or of a magnitude beyond largest_coordinate. NaN
/// is none of these: it marks a point as absent.
std::optional<Error> misplaced(std::size_t index, Point3 p);

/// NaN in any coordinate: how scans keep the place of a ray that met nothing.
inline bool is_absent(Point3 p)
{
    return std::isnan(p.x) || std::isnan(p.y) || std::isnan(p.z);
}
inline bool is_placed(Point3 p)
{
    return std::abs(p.x) <= largest_coordinate && std::abs(p.y) <= largest_coordinate &&
           std::abs(p.z) <= largest_coordinate;  // false for NaN, too
}

/// Puts the points of Mesh::absent where the first of the others is, and says in a note how many
/// there are. Error: NoGeometry if there are no others.
std::optional<Error> place_absent(Mesh& mesh);

}  // namespace relight
