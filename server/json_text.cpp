#include "server/json_text.h"

#include <array>
#include <charconv>

namespace relight {
namespace {

/// Length of the UTF-8 sequence at the start of `text`, 0 if there is none (RFC 3629: no overlong
/// forms, no surrogates, nothing above U+10FFFF).
std::size_t utf8_length(std::string_view text)
{
    const auto at = [&](std::size_t i) {
        return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U;
    };
    const auto follows = [&](std::size_t i) { return (at(i) & 0xC0U) == 0x80U; };
    const unsigned a = at(0);
    const unsigned b = at(1);
    if (a < 0x80) { return 1; }
    if (a >= 0xC2 && a <= 0xDF) { return follows(1) ? 2 : 0; }
    if (a >= 0xE0 && a <= 0xEF) {
        if ((a == 0xE0 && b < 0xA0) || (a == 0xED && b > 0x9F)) { return 0; }
        return follows(1) && follows(2) ? 3 : 0;
    }
    if (a >= 0xF0 && a <= 0xF4) {
        if ((a == 0xF0 && b < 0x90) || (a == 0xF4 && b > 0x8F)) { return 0; }
        return follows(1) && follows(2) && follows(3) ? 4 : 0;
    }
    return 0;
}

void append_escaped(std::string& out, char c)
{
    switch (c) {
        case '"':
            out += "\\\"";
            return;
        case '\\':
            out += "\\\\";
            return;
        case '\n':
            out += "\\n";
            return;
        case '\r':
            out += "\\r";
            return;
        case '\t':
            out += "\\t";
            return;
        default:
            break;
    }
    constexpr std::string_view hex_digits = "0123456789abcdef";
    const auto code = static_cast<unsigned char>(c);
    out += "\\u00";
    out += hex_digits[code >> 4U];
    out += hex_digits[code & 15U];
}

}  // namespace

void append_quoted(std::string& out, std::string_view text)
{
    out += '"';
    while (!text.empty()) {
        const char c = text.front();
        const std::size_t length = utf8_length(text);
        if (length == 0) {
            out += "\xEF\xBF\xBD";
        } else if (c == '"' || c == '\\' || static_cast<unsigned char>(c) < 0x20 || c == 0x7F) {
            append_escaped(out, c);
        } else {
            out += text.substr(0, length);
        }
        text.remove_prefix(length == 0 ? 1 : length);
    }
    out += '"';
}

std::string json_string(std::string_view text)
{
    std::string out;
    append_quoted(out, text);
    return out;
}

std::string decimal(double value)
{
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.begin(), digits.end(), value).ptr;
    return {digits.begin(), end};
}

std::string json_of(Vec3 v)
{
    return "[" + decimal(v.x) + "," + decimal(v.y) + "," + decimal(v.z) + "]";
}

std::string text_array(const std::vector<std::string>& texts)
{
    std::string json = "[";
    for (const std::string& text : texts) {
        if (json.size() > 1) { json += ','; }
        append_quoted(json, text);
    }
    return json + "]";
}

std::string printable(std::string_view text, std::size_t longest)
{
    std::string out(text.substr(0, longest));
    for (char& c : out) {
        if (c < ' ' || c > '~') { c = '?'; }
    }
    if (text.size() > longest) { out += "…"; }
    return out;
}

ObjectWriter& ObjectWriter::raw(std::string_view name, std::string_view json)
{
    if (json_.size() > 1) { json_ += ','; }
    append_quoted(json_, name);
    json_ += ':';
    json_ += json;
    return *this;
}

}  // namespace relight
