#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <optional>
#include <string>
#include <utility>

#include "core/geometry/precision.h"
#include "core/io/coordinate.h"
#include "core/io/readers.h"
#include "core/io/text_scanner.h"
#include "core/io/utf8.h"

namespace relight {
namespace {

constexpr std::size_t block = 65'536;  // facets between two looks at Progress
constexpr std::size_t header = 84;     // 80 bytes of anything, then the count of facets
constexpr std::size_t facet = 50;      // normal, three vertices: 12 floats; 2 bytes of anything

using Failure = std::optional<Error>;

/// The mesh as it grows: three vertices of its own a facet.
struct Facets {
    Mesh mesh;
    std::size_t disagreeing = 0;  // filed normals that contradict the winding

    /// Adds a facet that was filed with the normal `filed`. That one is only compared: the winding
    /// decides, and normals of unshared vertices are those of their facet.
    void add(Vec3 filed, const std::array<Point3, 3>& corners)
    {
        const Dir3 wound = normalize(cross(corners[1] - corners[0], corners[2] - corners[0]));
        const Dir3 said = normalize(filed);
        constexpr double agree = 0.5;  // cosine: files round their normals, but not by 60 degrees
        if (wound && said && dot(wound, said) <= agree) { ++disagreeing; }
        for (const Point3 corner : corners) {
            mesh.faces.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
            mesh.positions.push_back(corner);
        }
    }
};

Failure beyond(std::uint64_t facets, const ReadLimits& limits)
{
    const auto error = [](Fault fault, const char* what, std::uint64_t most) {
        return Error{fault,
                     std::string("more ") + what + " than the limit of " + std::to_string(most) +
                         " (three vertices a facet); send a coarser mesh or one in parts",
                     {},
                     {},
                     {}};
    };
    if (facets > limits.faces) { return error(Fault::TooManyFaces, "facets", limits.faces); }
    if (facets > std::min<std::uint64_t>(limits.vertices, 0xFFFFFFFF) / 3) {
        return error(Fault::TooManyVertices, "vertices", limits.vertices);
    }
    return {};
}

Error cancelled()
{
    return {Fault::Cancelled, "reading was stopped", {}, {}, {}};
}

Result<Mesh> finished(Facets facets)
{
    if (facets.mesh.positions.empty()) {
        return Error{Fault::NoGeometry, "the file has no facets", {}, {}, {}};
    }
    facets.mesh.format = "stl";
    if (facets.disagreeing > 0) {
        facets.mesh.notes.push_back(std::to_string(facets.disagreeing) +
                                    " facet normals disagree with the winding of their vertices by "
                                    "60 degrees or more; the winding is used");
    }
    return std::move(facets.mesh);
}

template <class T>
T load(std::span<const std::byte> from)
{
    static_assert(std::endian::native == std::endian::little);
    T value;
    std::memcpy(&value, from.data(), sizeof(T));
    return value;
}

/// Size must be exactly what the count says: a file cut or glued is not guessed at.
Failure wrong_size(std::uint64_t size, std::uint64_t count)
{
    const std::uint64_t expected = header + count * facet;
    if (size == expected) { return {}; }
    const std::string what = "announces " + std::to_string(count) + " facets, which take " +
                             std::to_string(expected) + " bytes; the file has " +
                             std::to_string(size);
    if (size < expected) { return Error{Fault::CountExceedsFile, what, {}, {}, header - 4}; }
    return Error{Fault::MalformedBody, what, {}, {}, expected};
}

Result<Mesh> read_binary(std::span<const std::byte> file, const ReadLimits& limits,
                         Progress& progress)
{
    if (file.size() < header) {
        return Error{Fault::Truncated,
                     "an STL file starts with the word solid, or with 84 bytes of header if it is "
                     "binary; this one ends before",
                     {},
                     {},
                     file.size()};
    }
    const auto count = load<std::uint32_t>(file.subspan(header - 4));
    if (auto failure = wrong_size(file.size(), count)) { return std::move(*failure); }
    if (auto failure = beyond(count, limits)) { return std::move(*failure); }
    Facets facets;
    facets.mesh.positions.reserve(std::size_t{count} * 3);
    facets.mesh.faces.indices.reserve(std::size_t{count} * 3);
    for (std::size_t f = 0; f < count; ++f) {
        if (f % block == 0 && progress.stopped()) { return cancelled(); }
        const std::size_t at = header + f * facet;
        const auto floats = load<std::array<float, 12>>(file.subspan(at));
        const auto vec = [&](std::size_t i) {
            return Vec3{floats[i], floats[i + 1], floats[i + 2]};
        };
        for (std::size_t i = 3; i < floats.size(); ++i) {
            if (!(std::abs(floats[i]) <= largest_coordinate)) {
                const bool finite = std::isfinite(floats[i]);
                return Error{finite ? Fault::CoordinateTooLarge : Fault::NonFiniteCoordinate,
                             finite ? "a coordinate is beyond the largest magnitude allowed, 1e15; "
                                      "choose a larger unit"
                                    : "a coordinate is not a finite number",
                             {},
                             {},
                             at + i * sizeof(float)};
            }
        }
        facets.add(vec(0), {Point3{} + vec(3), Point3{} + vec(6), Point3{} + vec(9)});
    }
    return finished(std::move(facets));
}

/// solid name / facet normal x y z / outer loop / vertex x y z, thrice / endloop / endfacet /
/// endsolid name: any case, any blanks and line ends between words, several solids.
class AsciiReader {
  public:
    AsciiReader(std::span<const std::byte> file, const ReadLimits& limits, Progress& progress)
        : scanner_(file), limits_(limits), progress_(progress)
    {
    }

    Result<Mesh> read()
    {
        bool inside = false;  // a solid
        for (std::string_view next = scanner_.word_on_any_line(); !next.empty();
             next = scanner_.word_on_any_line()) {
            const bool begins = same(next, "solid");
            if (inside && same(next, "facet")) {
                if (auto failure = facet()) { return std::move(*failure); }
            } else if (begins != inside && (begins || same(next, "endsolid"))) {
                inside = begins;
                scanner_.rest_of_line();  // its name
            } else {
                return unexpected(next, inside ? "facet or endsolid" : "solid");
            }
        }
        if (inside) {
            return scanner_.error(Fault::Truncated,
                                  "the file ends inside a solid; expected facet or endsolid");
        }
        facets_.mesh.double_positions = float_loses_text(facets_.mesh.positions);
        return finished(std::move(facets_));
    }

  private:
    static bool same(std::string_view word, std::string_view lower)
    {
        const auto equal = [](char a, char b) {
            return a == b || (a >= 'A' && a <= 'Z' && a - 'A' + 'a' == b);
        };
        return std::equal(word.begin(), word.end(), lower.begin(), lower.end(), equal);
    }

    Error unexpected(std::string_view found, std::string_view expected) const
    {
        if (found.empty()) {
            return scanner_.error(Fault::Truncated,
                                  "the file ends where " + std::string(expected) + " was expected");
        }
        return scanner_.error(Fault::MalformedBody,
                              shown(found) + "; expected " + std::string(expected));
    }

    /// Passes over these words.
    template <std::size_t N>
    Failure expect(const std::array<std::string_view, N>& words)
    {
        for (const std::string_view expected : words) {
            const std::string_view next = scanner_.word_on_any_line();
            if (!same(next, expected)) { return unexpected(next, expected); }
        }
        return {};
    }

    /// Lenient: nan, as exporters write the normal of a facet without area, is taken for 0.
    Result<Vec3> three_numbers(std::string_view expected, bool lenient)
    {
        std::array<double, 3> n{};
        for (double& out : n) {
            const std::string_view next = scanner_.word_on_any_line();
            if (next.empty()) { return unexpected(next, expected); }
            const Result<double> number = parse_coordinate(next, expected, scanner_.line());
            if (!number && !(lenient && number.error().fault == Fault::NonFiniteCoordinate)) {
                return number.error();
            }
            out = number ? *number : 0.0;
        }
        return Vec3{n[0], n[1], n[2]};
    }

    /// What follows the word facet.
    Failure facet()
    {
        const std::size_t filed = facets_.mesh.faces.count();
        if (filed % block == 0 && progress_.stopped()) { return cancelled(); }
        if (auto failure = beyond(filed + 1, limits_)) { return failure; }
        if (auto failure = expect(std::array<std::string_view, 1>{"normal"})) { return failure; }
        const Result<Vec3> normal = three_numbers("facet normal x y z", true);
        if (!normal) { return normal.error(); }
        if (auto failure = expect(std::array<std::string_view, 2>{"outer", "loop"})) {
            return failure;
        }
        std::array<Point3, 3> corners;
        for (Point3& corner : corners) {
            if (auto failure = expect(std::array<std::string_view, 1>{"vertex"})) {
                return failure;
            }
            const Result<Vec3> at = three_numbers("vertex x y z", false);
            if (!at) { return at.error(); }
            corner = Point3{} + *at;
        }
        if (auto failure = expect(std::array<std::string_view, 2>{"endloop", "endfacet"})) {
            return failure;
        }
        facets_.add(*normal, corners);
        return {};
    }

    TextScanner scanner_;
    const ReadLimits& limits_;
    Progress& progress_;
    Facets facets_;
};

/// The size decides first: binary headers may begin with "solid" too. A header's count, or the
/// padding before it, holds a zero byte; text never does.
bool is_binary(std::span<const std::byte> file)
{
    if (file.size() >= header && file.size() == header + facet * std::uint64_t{load<std::uint32_t>(
                                                                     file.subspan(header - 4))}) {
        return true;
    }
    const auto head = file.first(std::min(file.size(), header));
    return std::find(head.begin(), head.end(), std::byte{0}) != head.end();
}

}  // namespace

Result<Mesh> read_stl(std::span<const std::byte> file, const ReadLimits& limits, Progress& progress)
{
    if (file.empty()) { return Error{Fault::EmptyFile, "the file has no bytes", {}, {}, {}}; }
    return is_binary(file) ? read_binary(file, limits, progress)
                           : AsciiReader(without_byte_order_mark(file), limits, progress).read();
}

}  // namespace relight
