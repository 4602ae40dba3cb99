#pragma once

#include <cmath>
#include <cstdint>
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

}  // namespace relight
