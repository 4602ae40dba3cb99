#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace relight::http_text {

// What RFC 9110 and 3986 call these things, in ASCII whatever the locale.

inline bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}
inline bool is_alpha(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}
inline char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

inline int hex_value(char c)
{
    if (is_digit(c)) { return c - '0'; }
    const char l = lower(c);
    return l >= 'a' && l <= 'f' ? l - 'a' + 10 : -1;
}

inline std::string lowered(std::string_view text)
{
    std::string out(text);
    std::transform(out.begin(), out.end(), out.begin(), lower);
    return out;
}

/// tchar of RFC 9110, 5.6.2.
inline bool is_token(std::string_view text)
{
    static constexpr std::string_view marks = "!#$%&'*+-.^_`|~";
    return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
        return is_alpha(c) || is_digit(c) || marks.find(c) != std::string_view::npos;
    });
}

inline std::string_view trimmed(std::string_view text)
{
    const auto first = text.find_first_not_of(" \t");
    if (first == std::string_view::npos) { return {}; }
    return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// host[:port] of RFC 3986 without user information or escapes; may be empty.
inline bool is_authority(std::string_view text)
{
    static constexpr std::string_view marks = "-._~!$&'()*+,;=:[]";
    return text.size() <= 300 && std::all_of(text.begin(), text.end(), [](char c) {
               return is_alpha(c) || is_digit(c) || marks.find(c) != std::string_view::npos;
           });
}

/// Visible ASCII without '#', escapes whole and not of control characters.
inline bool is_target_text(std::string_view text)
{
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c <= 0x20 || c >= 0x7f || c == '#') { return false; }
        if (c != '%') { continue; }
        if (i + 2 >= text.size()) { return false; }
        const int high = hex_value(text[i + 1]);
        const int low = hex_value(text[i + 2]);
        if (high < 0 || low < 0) { return false; }
        const int byte = 16 * high + low;
        if (byte < 0x20 || byte == 0x7f) { return false; }
    }
    return true;
}

}  // namespace relight::http_text
