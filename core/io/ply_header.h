#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace relight::ply {

enum class Encoding { Ascii, BinaryLittleEndian, BinaryBigEndian };
enum class Scalar : unsigned char { I8, U8, I16, U16, I32, U32, F32, F64 };

/// Bytes of one value in a binary body.
constexpr std::size_t size_of(Scalar type)
{
    constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    return sizes[static_cast<std::size_t>(type)];
}
constexpr bool is_integer(Scalar type)
{
    return type < Scalar::F32;
}
std::string_view name_of(Scalar type);  ///< "uchar", as the header says it

/// Names point into the file.
struct Property {
    std::string_view name;
    Scalar type{};                ///< of the value, or of a list's entries
    std::optional<Scalar> count;  ///< set: a list, and the type of its length (an integer)
};

struct Element {
    std::string_view name;
    std::uint64_t count{};
    std::vector<Property> properties;  ///< names are unique

    /// Place of the property of that name.
    std::optional<std::size_t> find(std::string_view wanted) const;
    /// Bytes of a record in a binary body; nothing if lists make it vary.
    std::optional<std::size_t> stride() const;
};

struct Header {
    Encoding encoding{};
    std::vector<Element> elements;  ///< names are unique
    std::size_t body{};             ///< where the body starts [byte]
    std::uint64_t body_line{};      ///< and on which line

    const Element* find(std::string_view wanted) const;
};

/// Longest header read. 10,000 properties take a quarter of it.
inline constexpr std::size_t longest_header = std::size_t{1} << 20;

/// The header of a PLY file (Turk 1994, and the liberties its writers take: CR and CR LF, blanks
/// and empty lines anywhere, comments before the format line, int8 for char). Errors: EmptyFile,
/// MalformedHeader.
Result<Header> read_header(std::span<const std::byte> file);

}  // namespace relight::ply
