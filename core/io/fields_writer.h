#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/base/rgb.h"
#include "core/io/sink.h"

namespace relight {

/// How the numbers of a field are sent.
enum class FieldType {
    Float32,
    Float16,  ///< binary16, to the nearest; beyond +-65504 clamped and counted in the head
    UInt8     ///< sRGB codes as they are; of floats, shares of 0..1: round(255 x), clamped, NaN 0
};

/// "float32", "float16", "uint8", as in the head; and back, nothing for any other name.
std::string_view name_of(FieldType type);
std::optional<FieldType> field_type(std::string_view name);

/// One array of the answer: `components` numbers a vertex.
struct Field {
    std::string name;  ///< any text: "irradiance", "visibility/key"
    FieldType type = FieldType::Float32;
    int components = 3;                                                  ///< of codes: 3
    std::variant<std::span<const float>, std::span<const Rgb8>> values;  ///< codes: UInt8 only
    std::string unit;                                                    ///< "W/m2", "sRGB", "1"
};

/// Raw arrays for programs that read them as they come (application/octet-stream):
///
///     u32, little-endian: length of the head, such that 4 + length is a multiple of 8
///     the head: JSON in UTF-8, filled up with spaces
///     the arrays: V * components numbers each, little-endian, vertex after vertex, beginning at a
///     multiple of 8 and filled up with zeros to one
///
///     {"vertices":V,"fields":[{"name":"irradiance","type":"float16","components":3,"offset":0,
///     "bytes":6000,"unit":"W/m2","clamped":0},…],…,"bytes_total":6200}
///
/// `offset` counts from the end of the head; `clamped` (float16 alone) are the numbers that were
/// beyond its range; `bytes_total` is the whole message from its first byte, so that messages can
/// follow one another; `more` are further members as JSON ("\"samples\":16,\"final\":false"), or
/// nothing. Absent points stay NaN where a field's type knows it.
/// Each field has `vertices` values of its components. What their spans show must outlive the
/// encoding.
Encoding encode_fields(std::size_t vertices, std::vector<Field> fields, std::string_view more = {});

}  // namespace relight
