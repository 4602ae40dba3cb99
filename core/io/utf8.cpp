#include "core/io/utf8.h"

#include <algorithm>
#include <array>

namespace relight {
namespace {

/// Bytes of the well-formed sequence at the start of `text`, 0 if there is none (Unicode, table
/// 3-7).
std::size_t sequence_length(std::string_view text)
{
    const auto in = [&](std::size_t i, unsigned low, unsigned high) {
        if (i >= text.size()) { return false; }
        const auto byte = static_cast<unsigned char>(text[i]);
        return byte >= low && byte <= high;
    };
    const auto tail = [&](std::size_t i) { return in(i, 0x80, 0xBF); };
    if (in(0, 0x00, 0x7F)) { return 1; }
    if (in(0, 0xC2, 0xDF) && tail(1)) { return 2; }
    const bool three = (in(0, 0xE0, 0xE0) && in(1, 0xA0, 0xBF)) ||
                       (in(0, 0xED, 0xED) && in(1, 0x80, 0x9F)) ||
                       ((in(0, 0xE1, 0xEC) || in(0, 0xEE, 0xEF)) && tail(1));
    if (three && tail(2)) { return 3; }
    const bool four = (in(0, 0xF0, 0xF0) && in(1, 0x90, 0xBF)) || (in(0, 0xF1, 0xF3) && tail(1)) ||
                      (in(0, 0xF4, 0xF4) && in(1, 0x80, 0x8F));
    return four && tail(2) && tail(3) ? 4 : 0;
}

}  // namespace

bool is_utf8(std::string_view text)
{
    while (!text.empty()) {
        const std::size_t length = sequence_length(text);
        if (length == 0) { return false; }
        text.remove_prefix(length);
    }
    return true;
}

std::string as_utf8(std::string_view name)
{
    if (is_utf8(name)) { return std::string(name); }
    std::string out;
    for (const char c : name) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x80) {
            out += c;
        } else {  // U+0080 .. U+00FF: two bytes
            out += static_cast<char>(0xC0 | byte >> 6);
            out += static_cast<char>(0x80 | (byte & 0x3F));
        }
    }
    return out;
}

std::span<const std::byte> without_byte_order_mark(std::span<const std::byte> file)
{
    constexpr std::array mark{std::byte{0xEF}, std::byte{0xBB}, std::byte{0xBF}};
    const bool marked =
        file.size() >= mark.size() && std::equal(mark.begin(), mark.end(), file.begin());
    return file.subspan(marked ? mark.size() : 0);
}

}  // namespace relight
