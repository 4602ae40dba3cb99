#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/base/result.h"
#include "core/base/rgb.h"
#include "core/base/vec.h"

namespace relight {

struct Json;
struct JsonMember;
using JsonArray = std::vector<Json>;
using JsonObject = std::vector<JsonMember>;

/// Stands in the tree for an array whose numbers went straight into InlineArrays.
struct BulkArray {};

/// A value of a request. No deeper than json_depth, so that taking it apart never overflows the
/// stack.
struct Json {
    std::variant<std::nullptr_t, bool, double, std::string, JsonArray, JsonObject, BulkArray> value;
};
struct JsonMember {
    std::string name;
    Json value;
};

inline constexpr std::size_t json_depth = 32;
inline constexpr std::size_t json_members = 1024;    ///< of one object; so many "materials", too
inline constexpr std::size_t json_values = 200'000;  ///< of the tree; inline arrays are not in it

/// "/mesh/positions", "/mesh/faces", "/mesh/normals", "/mesh/colors": rows of three numbers each,
/// checked for shape, finiteness and sign, not against each other.
struct InlineArrays {
    std::vector<Point3> positions;
    std::vector<std::uint32_t> faces;
    std::vector<Vec3> normals;
    std::vector<Rgbf> colors;
};

struct ParsedJson {
    Json root;
    InlineArrays mesh;
};

/// Reads a request's text. Errors: MalformedJson with `line` (also invalid UTF-8 and anything after
/// the end), JsonTooDeep, DuplicateField, NotFinite (1e999), and for the inline arrays WrongType,
/// WrongLength, OutOfRange, IndexOutOfRange, CoordinateTooLarge, ZeroDirection, TooManyVertices,
/// TooManyFaces.
Result<ParsedJson> parse_json(std::string_view text, std::uint64_t max_vertices,
                              std::uint64_t max_faces);

/// An error at a place of the request.
inline Error make_error(Fault fault, std::string detail, std::string pointer = {})
{
    return {fault, std::move(detail), std::move(pointer), {}, {}};
}

/// A name as a step of a JSON pointer (RFC 6901): "/" and '~' as ~0, '/' as ~1.
std::string pointer_step(std::string_view name);
inline std::string pointer_step(std::size_t index)
{
    return std::string("/") + std::to_string(index);
}

/// What a value is, for messages: "a string", "an array of 2", "the number 3".
std::string description_of(const Json& json);

}  // namespace relight
