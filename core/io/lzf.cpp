#include "core/io/lzf.h"

#include <algorithm>

namespace relight {

std::optional<std::vector<std::byte>> unpack_lzf(std::span<const std::byte> packed,
                                                 std::size_t size)
{
    if (size > most_unpacked(packed.size())) { return {}; }
    std::vector<std::byte> out(size);
    std::size_t from = 0, to = 0;
    while (from < packed.size()) {
        const auto control = std::to_integer<std::size_t>(packed[from++]);
        if (control < 32) {  // control + 1 literals
            const std::size_t length = control + 1;
            if (length > packed.size() - from || length > size - to) { return {}; }
            std::copy_n(packed.data() + from, length, out.data() + to);
            from += length;
            to += length;
            continue;
        }
        std::size_t length = control / 32 + 2;  // the upper three bits; all set: one byte more
        const std::size_t needs = length == 9 ? 2 : 1;
        if (needs > packed.size() - from) { return {}; }
        if (needs == 2) { length += std::to_integer<std::size_t>(packed[from++]); }
        const std::size_t back =
            control % 32 * 256 + std::to_integer<std::size_t>(packed[from++]) + 1;
        if (back > to || length > size - to) { return {}; }
        std::byte* const target = out.data() + to;
        if (back >= length) {
            std::copy_n(target - back, length, target);
        } else {  // reads what it writes: the pattern repeats
            for (std::size_t i = 0; i < length; ++i) { target[i] = (target - back)[i]; }
        }
        to += length;
    }
    if (to != size) { return {}; }
    return out;
}

}  // namespace relight
