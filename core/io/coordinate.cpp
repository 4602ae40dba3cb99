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

bool says_nan(std::string_view word)
{
    // nan, NaN(snan), -1.#IND, 1.#QNAN; no spelling of infinity has an A or a D.
    return word.find_first_of("aADd") != std::string_view::npos;
}

std::optional<Error> misplaced(std::size_t index, Point3 p)
{
    if (is_placed(p) || is_absent(p)) { return {}; }
    const std::string point = "point " + std::to_string(index);
    if (!is_finite(p)) {
        return Error{Fault::NonFiniteCoordinate,
                     point + " has an infinite coordinate; write NaN for a point without a place",
                     {},
                     {},
                     {}};
    }
    return Error{Fault::CoordinateTooLarge,
                 point +
                     " has a coordinate beyond the largest magnitude allowed, 1e15; choose a "
                     "larger unit",
                 {},
                 {},
                 {}};
}

std::optional<Error> place_absent(Mesh& mesh)
{
    if (mesh.absent.empty()) { return {}; }
    if (mesh.absent.size() == mesh.positions.size()) {
        return Error{Fault::NoGeometry, "every point has a NaN coordinate", {}, {}, {}};
    }
    std::size_t present = 0;  // the first index that is not in the list
    while (present < mesh.absent.size() && mesh.absent[present] == present) { ++present; }
    for (const std::uint32_t i : mesh.absent) { mesh.positions[i] = mesh.positions[present]; }
    mesh.notes.push_back(std::to_string(mesh.absent.size()) +
                         " points have NaN coordinates: they keep their places and stay unlit");
    return {};
}

}  // namespace relight
