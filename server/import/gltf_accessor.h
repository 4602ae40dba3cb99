#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/import/gltf_file.h"

namespace relight::gltf {

/// glTF's numbers of the types that a component may have.
enum class Component : std::uint16_t {
    I8 = 5120,
    U8 = 5121,
    I16 = 5122,
    U16 = 5123,
    U32 = 5125,
    F32 = 5126,
};

std::size_t bytes_of(Component component);

/// Where the elements of one array lie: every one of them within `bytes`.
struct Layout {
    Component component{};
    bool normalized = false;           ///< integers stand for [0, 1] or [-1, 1]
    std::size_t rows = 1, columns = 1; /**< columns > 1: a matrix, column by column, each from a
                                            multiple of 4 bytes on */
    std::size_t stride = 0;            ///< from element to element [bytes]
    std::span<const std::byte> bytes;  ///< from the first element on; none: all zero

    std::size_t width() const { return rows * columns; }
    std::size_t element_bytes() const;
};

/// An accessor that holds what it announces; nothing is read yet.
struct Accessor {
    std::string where;
    std::uint64_t count = 0;
    Layout layout;
    struct Sparse {
        std::uint64_t count = 0;
        Layout indices, values;
    };
    std::optional<Sparse> sparse;
};

/// /accessors/`index`, for the member at `asked_at`. Its elements lie within its view; one without
/// a view (all zero, or Draco's) takes no byte of the file, so that `count` may be any number: hold
/// it against a limit before reading.   Errors: CountExceedsFile, OutOfRange, MalformedBody.
Accessor accessor(File& file, std::uint64_t index, std::string_view asked_at);

/// count * width() numbers, integers normalized where the accessor says so; a matrix column by
/// column.   Errors: NonFiniteCoordinate; MalformedBody for unsigned 32-bit integers.
std::vector<float> floats(const Accessor& accessor);

/// count * width() integers.   Errors: MalformedBody if they are not unsigned.
std::vector<std::uint32_t> integers(const Accessor& accessor);

}  // namespace relight::gltf
