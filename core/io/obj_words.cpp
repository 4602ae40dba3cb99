#include "core/io/obj_words.h"

#include <optional>
#include <string>
#include <utility>

#include "core/io/coordinate.h"

namespace relight {
namespace {

/// "3.1+e2" as 3.1e+2: some exporters put the exponent's sign before its letter.
std::optional<std::string> with_exponent_mended(std::string_view word)
{
    const std::size_t e = word.find_first_of("eE", 1);
    if (e == std::string_view::npos || (word[e - 1] != '+' && word[e - 1] != '-')) { return {}; }
    std::string mended(word);
    std::swap(mended[e - 1], mended[e]);
    return mended;
}

}  // namespace

std::string_view ObjWords::name()
{
    if (scanner_.at_line_end()) { return {}; }
    std::string_view text = scanner_.rest_of_line();
    while (TextScanner::is_blank(text.back())) { text.remove_suffix(1); }
    return text;
}

Result<std::size_t> ObjWords::numbers(std::span<double> out, std::size_t least,
                                      std::string_view expected)
{
    std::size_t count = 0;
    for (;;) {
        if (count < out.size()) {
            if (const auto plain = scanner_.plain_real(largest_coordinate)) {
                out[count++] = *plain;
                continue;
            }
        }
        const std::string_view next = word();
        if (next.empty()) { break; }
        Result<double> number = parse_coordinate(next, expected, line_);
        if (!number && number.error().fault == Fault::MalformedBody) {
            if (const auto mended = with_exponent_mended(next)) {
                number = parse_coordinate(*mended, expected, line_);
                ++swapped_exponents_;
            }
        }
        if (!number) { return number.error(); }
        if (count == out.size()) {
            return error(Fault::MalformedBody, shown(next) + " is one number too many; expected " +
                                                   std::string(expected));
        }
        out[count++] = *number;
    }
    if (count < least) {
        return error(Fault::MalformedBody,
                     std::to_string(count) + " numbers; expected " + std::string(expected));
    }
    return count;
}

}  // namespace relight
