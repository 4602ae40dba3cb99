#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/io/sink.h"

namespace relight {

/// A part of an answer whose size is known before it is written: `write` appends as many bytes, the
/// same at each call. What it was made of must still be there.
struct Piece {
    std::uint64_t bytes = 0;
    std::function<void(BlockOut&)> write;
};

inline Piece text_piece(std::string text)
{
    const std::uint64_t bytes = text.size();
    return {bytes, [text = std::move(text)](BlockOut& out) { out.bytes(text); }};
}

/// An array as it lies in memory.
template <class T>
Piece span_piece(std::span<const T> values)
{
    static_assert(std::is_trivially_copyable_v<T>);
    return {values.size_bytes(), [values](BlockOut& out) {
                out.bytes({reinterpret_cast<const char*>(values.data()), values.size_bytes()});
            }};
}

/// value(i), an array of numbers, for the `n` rows from `first` on, `stride` bytes apart.
template <class Value>
void fill_rows(const Value& value, std::size_t first, std::size_t n, char* out, std::size_t stride)
{
    for (std::size_t i = first; i < first + n; ++i, out += stride) {
        // One by one: an array put together in memory and read back at once waits for its stores,
        // which takes twice as long.
        const auto numbers = value(i);
        for (std::size_t k = 0; k < numbers.size(); ++k) {
            std::memcpy(out + k * sizeof(numbers[k]), &numbers[k], sizeof(numbers[k]));
        }
    }
}

/// `count` rows of value(i), an array of numbers each.
template <class Value>
Piece rows_piece(std::size_t count, Value value)
{
    constexpr std::size_t row = sizeof(decltype(value(std::size_t{})));
    return {std::uint64_t{count} * row, [count, value = std::move(value)](BlockOut& out) {
                constexpr std::size_t rows = 1024;  // stay in the nearest cache
                for (std::size_t first = 0; first < count && out.open(); first += rows) {
                    const std::size_t n = std::min(rows, count - first);
                    fill_rows(value, first, n, out.room(n * row), row);
                }
            }};
}

/// One behind the other.
inline Encoding joined(std::vector<Piece> pieces)
{
    std::uint64_t bytes = 0;
    for (const Piece& piece : pieces) { bytes += piece.bytes; }
    return {bytes, [pieces = std::move(pieces)](const Sink& sink) {
                BlockOut out(sink);
                for (const Piece& piece : pieces) {
                    if (out.open()) { piece.write(out); }
                }
                return out.flush();
            }};
}

}  // namespace relight
