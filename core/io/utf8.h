#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace relight {

/// True if `text` is UTF-8: no overlong form, no surrogate, nothing beyond U+10FFFF.
bool is_utf8(std::string_view text);

/// A file's name for something, as JSON can carry it: what is not UTF-8 is taken for Latin-1, as
/// old exporters write it.
std::string as_utf8(std::string_view name);

/// The text behind the three bytes that some editors put before it to say that it is UTF-8.
std::span<const std::byte> without_byte_order_mark(std::span<const std::byte> file);

}  // namespace relight
