#include <charconv>
#include <cmath>

#include "core/io/writers.h"

namespace relight {
namespace {

void write_number(BlockOut& out, float value)
{
    if (!std::isfinite(value)) { return out.bytes("null"); }  // JSON has no such numbers
    constexpr std::size_t longest = 32;
    char* const begin = out.room(longest);
    out.end_at(std::to_chars(begin, begin + longest, value).ptr);
}

}  // namespace

void write_json(BlockOut& out, std::span<const float> values, int components)
{
    const auto step = static_cast<std::size_t>(components);
    out.bytes("[");
    for (std::size_t i = 0; i < values.size() && out.open(); i += step) {
        if (i > 0) { out.bytes(","); }
        if (step > 1) { out.bytes("["); }
        for (std::size_t k = 0; k < step; ++k) {
            if (k > 0) { out.bytes(","); }
            write_number(out, values[i + k]);
        }
        if (step > 1) { out.bytes("]"); }
    }
    out.bytes("]");
}

void append_json(std::string& text, std::span<const float> values, int components)
{
    text.reserve(text.size() + 12 * values.size());
    const Sink append = [&](std::string_view bytes) {
        text += bytes;
        return true;
    };
    BlockOut out(append);
    write_json(out, values, components);
    out.flush();
}

}  // namespace relight
