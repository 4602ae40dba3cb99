#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace relight {

/// The most bytes that `compressed` of them can unpack to: a run takes three and gives 264.
constexpr std::size_t most_unpacked(std::size_t compressed)
{
    return compressed * 88;
}

/// LZF (Lehmann's liblzf): literals of 1..32 bytes, and runs of 3..264 copied from up to 8192 bytes
/// back. Nothing if `packed` does not give exactly `size` bytes and end there.
std::optional<std::vector<std::byte>> unpack_lzf(std::span<const std::byte> packed,
                                                 std::size_t size);

}  // namespace relight
