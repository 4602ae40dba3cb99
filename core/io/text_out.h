#pragma once

#include <charconv>
#include <string>
#include <string_view>

#include "core/io/sink.h"

namespace relight {

/// Writes numbers as the fewest digits that read back exactly, a record a line.
struct TextOut {
    BlockOut& out;

    template <class T>
    void number(T value, char after = ' ')
    {
        constexpr std::size_t longest = 31;
        char* const begin = out.room(longest + 1);
        char* const end = std::to_chars(begin, begin + longest, value).ptr;
        *end = after;
        out.end_at(end + 1);
    }
    void end_record() { out.back() = '\n'; }
    bool open() const { return out.open(); }
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
