#include <charconv>
#include <cmath>

#include "core/io/writers.h"

namespace relight {
namespace {

void append_number(std::string& out, float value)
{
    if (!std::isfinite(value)) {  // JSON has no such numbers
        out += "null";
        return;
    }
    char digits[32];
    out.append(digits, std::to_chars(digits, digits + sizeof(digits), value).ptr);
}

}  // namespace

void append_json(std::string& out, std::span<const float> values, int components)
{
    const auto step = static_cast<std::size_t>(components);
    out.reserve(out.size() + 12 * values.size());
    out += '[';
    for (std::size_t i = 0; i < values.size(); i += step) {
        if (i > 0) { out += ','; }
        if (step > 1) { out += '['; }
        for (std::size_t k = 0; k < step; ++k) {
            if (k > 0) { out += ','; }
            append_number(out, values[i + k]);
        }
        if (step > 1) { out += ']'; }
    }
    out += ']';
}

}  // namespace relight
