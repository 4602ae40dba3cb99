#pragma once

#include <array>
#include <charconv>
#include <string>
#include <string_view>

namespace relight {

/// Appends numbers as the fewest digits that read back exactly, a record a line.
struct TextOut {
    std::string& out;

    template <class T>
    void number(T value, char after = ' ')
    {
        std::array<char, 32> digits;
        char* const end = std::to_chars(digits.data(), digits.data() + 31, value).ptr;
        *end = after;
        out.append(digits.data(), end + 1);
    }
    void end_record() { out.back() = '\n'; }
};

/// The text on one line, whatever it holds.
inline std::string one_line(std::string_view text)
{
    std::string out(text);
    for (char& c : out) {
        if (static_cast<unsigned char>(c) < ' ' || c == '\x7f') { c = ' '; }
    }
    return out;
}

}  // namespace relight
