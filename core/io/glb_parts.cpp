#include "core/io/glb_parts.h"

#include <array>
#include <charconv>
#include <cstring>
#include <limits>
#include <unordered_set>

#include "core/io/utf8.h"

namespace relight::glb {
namespace {

void append_u32(std::string& out, std::uint64_t value)
{
    std::array<char, 4> bytes{};
    const auto number = static_cast<std::uint32_t>(value);
    std::memcpy(bytes.data(), &number, sizeof(number));
    out.append(bytes.data(), bytes.size());
}

}  // namespace

std::string_view type_name(int components)
{
    constexpr std::array<std::string_view, 4> names{"SCALAR", "VEC2", "VEC3", "VEC4"};
    return names.at(static_cast<std::size_t>(components) - 1);
}

std::vector<Quantity3> attributes_of(std::span<const Quantity3> quantities)
{
    std::vector<Quantity3> named(quantities.begin(), quantities.end());
    std::unordered_set<std::string> taken;
    for (Quantity3& quantity : named) {
        for (char& c : quantity.name) {
            if (c >= 'a' && c <= 'z') { c = static_cast<char>(c - 'a' + 'A'); }
            const bool plain = (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
            if (!plain) { c = '_'; }
        }
        quantity.name.insert(0, "_");
        while (!taken.insert(quantity.name).second) { quantity.name += '_'; }
    }
    return named;
}

Piece padding_behind(std::uint64_t bytes)
{
    return text_piece(std::string((4 - bytes % 4) % 4, '\0'));
}

std::string quoted(std::string_view text)
{
    constexpr std::string_view hex_digits = "0123456789abcdef";
    std::string out = "\"";
    for (const char c : as_utf8(text)) {
        const auto code = static_cast<unsigned char>(c);
        if (code < 0x20) {
            out += "\\u00";
            out += hex_digits[code >> 4U];
            out += hex_digits[code & 15U];
            continue;
        }
        if (c == '"' || c == '\\') { out += '\\'; }
        out += c;
    }
    return out + '"';
}

std::string decimal(double value)
{
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.begin(), digits.end(), value).ptr;
    return {digits.begin(), end};
}

std::string begun(std::string_view json, std::uint64_t binary, std::uint64_t more)
{
    constexpr std::uint64_t file_head = 12, chunk_head = 8;
    const std::uint64_t padding = (4 - json.size() % 4) % 4;
    const std::uint64_t total = file_head + chunk_head + json.size() + padding +
                                (binary > 0 ? chunk_head + binary : 0) + more;
    if (total > std::numeric_limits<std::uint32_t>::max()) { return {}; }
    std::string out;
    out += "glTF";
    append_u32(out, 2);  // version
    append_u32(out, total);
    append_u32(out, json.size() + padding);
    append_u32(out, json_chunk);
    out += json;
    out.append(padding, ' ');
    if (binary > 0) {
        append_u32(out, binary);
        append_u32(out, binary_chunk);
    }
    return out;
}

}  // namespace relight::glb
