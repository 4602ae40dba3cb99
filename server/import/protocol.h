#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace relight::import_protocol {

// What the server and relight-import say to each other, through files in memory. The file stands in
// standard input; to standard output is written either a Header, then its `bytes` of content, with
// exit status `imported`, or one line "code detail" (a code of core/base/fault.h, at most
// `longest_refusal` bytes of printable ASCII), with status `refused`. The content of a picture is
// width * height texels of three 32-bit floats (linear R G B, row 0 on top), that of a glTF an
// archive (archive.h). Every other end (a signal, another status) means that the importer broke on
// the file.

static_assert(std::endian::native == std::endian::little, "numbers travel little endian");

struct Header {
    std::array<char, 8> magic{};
    std::uint64_t bytes{};            ///< that follow
    std::uint32_t width{}, height{};  ///< of a picture, as the next
    std::uint64_t negatives{};        ///< values below 0 that became 0
};
static_assert(sizeof(Header) == 32 && std::is_trivially_copyable_v<Header>);

inline constexpr std::array<char, 8> magic{'R', 'E', 'L', 'I', 'G', 'H', 'T', '2'};
inline constexpr std::size_t longest_refusal = 512;

inline constexpr int imported = 0, refused = 2;

}  // namespace relight::import_protocol
