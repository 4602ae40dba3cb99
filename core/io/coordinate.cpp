#include "core/io/coordinate.h"

#include <string>

namespace relight {

Error coordinate_error(NumberKind kind, std::string_view word, std::string_view expected,
                       std::uint64_t line)
{
    const auto error = [&](Fault fault, std::string detail) {
        return Error{fault, std::move(detail), {}, line, {}};
    };
    if (kind == NumberKind::NonFinite) {
        return error(Fault::NonFiniteCoordinate,
                     shown(word) + " is not finite; every number of the file must be");
    }
    if (kind == NumberKind::OutOfRange) {
        return error(
            Fault::CoordinateTooLarge,
            shown(word) + " is beyond the largest magnitude allowed, 1e15; choose a larger unit");
    }
    const std::string found =
        word.empty() ? "the line ends too early" : shown(word) + " is no number";
    return error(Fault::MalformedBody, found + "; expected " + std::string(expected));
}

}  // namespace relight
