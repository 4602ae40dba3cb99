#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/base/result.h"

namespace relight {

/// What a word of a text file says when read as a number.
enum class NumberKind {
    Ok,
    Malformed,   // not a number, or something hangs on its end
    OutOfRange,  // a number too large for the type
    NonFinite,   // nan or inf, in any spelling
};

template <class T>
struct Number {
    T value{};
    NumberKind kind = NumberKind::Ok;
    explicit operator bool() const { return kind == NumberKind::Ok; }
};

/// Integer with optional sign. No locale.
inline Number<std::int64_t> parse_integer(std::string_view word)
{
    if (word.starts_with('+') && !word.starts_with("+-")) { word.remove_prefix(1); }
    std::int64_t value = 0;
    const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (failure == std::errc::invalid_argument || end != word.data() + word.size()) {
        return {0, NumberKind::Malformed};
    }
    if (failure == std::errc::result_out_of_range) { return {0, NumberKind::OutOfRange}; }
    return {value};
}

/// True if the decimal number in `word`, which fits no double, is too small rather than too large.
inline bool underflows(std::string_view word)
{
    const std::size_t e = word.find_first_of("eE");
    const std::string_view digits = word.substr(0, e);
    const std::size_t first = digits.find_first_of("123456789");
    const std::size_t point = std::min(digits.find('.'), digits.size());
    std::int64_t exponent = 0;
    if (e != std::string_view::npos) {
        const Number<std::int64_t> read = parse_integer(word.substr(e + 1));
        if (read.kind == NumberKind::OutOfRange) { return word.substr(e + 1).starts_with('-'); }
        constexpr std::int64_t beyond_any_text = std::int64_t{1}
                                                 << 60;  // -exponent must not overflow
        exponent = std::max(read.value, -beyond_any_text);
    }
    return first == std::string_view::npos ||
           static_cast<std::int64_t>(point) - static_cast<std::int64_t>(first) < -exponent;
}

/// Decimal number as files write it: "1", "+1", "1.", ".5", "-0", "1E+05". No locale, no
/// hexadecimal. Too small for a double is 0; "1.#INF" and its kin count as NonFinite.
inline Number<double> parse_real(std::string_view word)
{
    if (word.starts_with('+') && !word.starts_with("+-")) { word.remove_prefix(1); }
    double value = 0.0;
    const auto [end, failure] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (failure == std::errc::invalid_argument) { return {0.0, NumberKind::Malformed}; }
    const std::string_view rest(end, static_cast<std::size_t>(word.data() + word.size() - end));
    if (rest.starts_with("#INF") || rest.starts_with("#IND") || rest.starts_with("#QNAN") ||
        rest.starts_with("#SNAN")) {
        return {0.0, NumberKind::NonFinite};
    }
    if (!rest.empty()) { return {0.0, NumberKind::Malformed}; }
    if (failure == std::errc::result_out_of_range) {
        return underflows(word) ? Number<double>{0.0} : Number<double>{0.0, NumberKind::OutOfRange};
    }
    if (!std::isfinite(value)) { return {0.0, NumberKind::NonFinite}; }
    return {value};
}

/// A client's word as an error may show it: short, printable ASCII, in quotes.
inline std::string shown(std::string_view word)
{
    std::string out = "'";
    for (const char c : word.substr(0, 24)) {
        out += c >= ' ' && c <= '~' && c != '\'' && c != '\\' ? c : '?';
    }
    return out + (word.size() > 24 ? "…'" : "'");
}

/// Walks the words and lines of an ASCII file. Lines end with LF, CR LF or CR. Words are what
/// stands between blanks (space, tab, vertical tab, form feed) on one line; comments are the
/// caller's matter.
class TextScanner {
  public:
    explicit TextScanner(std::span<const std::byte> file, std::size_t offset = 0,
                         std::uint64_t line = 1)
        : begin_(reinterpret_cast<const char*>(file.data())),
          at_(begin_ + offset),
          end_(begin_ + file.size()),
          line_(line)
    {
    }

    std::uint64_t line() const { return line_; }  ///< of the next byte, from 1
    std::size_t offset() const { return static_cast<std::size_t>(at_ - begin_); }
    std::size_t remaining() const { return static_cast<std::size_t>(end_ - at_); }
    bool at_end() const { return at_ == end_; }

    /// Skips blanks; true if nothing more stands on this line.
    bool at_line_end()
    {
        skip_blanks();
        return at_ == end_ || is_line_end(*at_);
    }

    /// The next word on this line; empty at its end.
    std::string_view word()
    {
        skip_blanks();
        const char* const start = at_;
        while (at_ != end_ && !is_blank(*at_) && !is_line_end(*at_)) { ++at_; }
        return {start, static_cast<std::size_t>(at_ - start)};
    }

    /// The number that stands next on this line, where it is plain: as from_chars takes it, of a
    /// magnitude up to `largest`, and nothing hangs on its end. Nothing: word() and parse_real()
    /// say what stands there; they go over each character thrice.
    std::optional<double> plain_real(double largest)
    {
        skip_blanks();
        double value = 0.0;
        const auto [end, failure] = std::from_chars(at_, end_, value);
        const bool small = std::abs(value) <= largest;  // false for NaN, too
        if (failure != std::errc() || !small || !ends_word(end)) { return {}; }
        at_ = end;
        return value;
    }

    /// The word that stands next on this line, where it is a, a/b, a//c or a/b/c of plain numbers
    /// from 1 up, as OBJ's faces have them; 0 for what is left out. False: word() says what stands
    /// there.
    bool plain_corner(std::array<std::uint32_t, 3>& numbers)
    {
        skip_blanks();
        const char* at = at_;
        numbers = {};
        bool plain = plain_index(at, numbers[0]);
        if (plain && at != end_ && *at == '/') {
            ++at;
            const bool skipped = at != end_ && *at == '/';
            if (!skipped) { plain = plain_index(at, numbers[1]); }
            if (plain && at != end_ && *at == '/') { plain = plain_index(++at, numbers[2]); }
        }
        if (!plain || !ends_word(at)) { return false; }
        at_ = at;
        return true;
    }

    /// The next word on this or a later line; empty at the end of the file.
    std::string_view word_on_any_line()
    {
        while (at_line_end() && at_ != end_) { next_line(); }
        return word();
    }

    /// What stands between here and the end of the line.
    std::string_view rest_of_line()
    {
        const char* const start = at_;
        while (at_ != end_ && !is_line_end(*at_)) { ++at_; }
        return {start, static_cast<std::size_t>(at_ - start)};
    }

    /// To the start of the next line.
    void next_line()
    {
        rest_of_line();
        if (at_ == end_) { return; }
        const bool pair = *at_ == '\r' && end_ - at_ > 1 && at_[1] == '\n';
        at_ += pair ? 2 : 1;
        ++line_;
    }

    /// An error that says on which line it stands.
    Error error(Fault fault, std::string detail) const
    {
        return {fault, std::move(detail), {}, line_, {}};
    }

    static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
    static bool is_line_end(char c) { return c == '\n' || c == '\r'; }

  private:
    void skip_blanks()
    {
        while (at_ != end_ && is_blank(*at_)) { ++at_; }
    }

    /// As many digits as surely fit, of a number from 1 up.
    bool plain_index(const char*& at, std::uint32_t& number) const
    {
        constexpr std::ptrdiff_t surely = 9;
        const char* const end = end_ - at > surely ? at + surely : end_;
        std::uint32_t value = 0;
        for (; at != end && *at >= '0' && *at <= '9'; ++at) {
            value = 10 * value + static_cast<std::uint32_t>(*at - '0');
        }
        number = value;
        return value > 0;
    }

    bool ends_word(const char* at) const { return at == end_ || is_blank(*at) || is_line_end(*at); }

    const char* begin_;
    const char* at_;
    const char* end_;
    std::uint64_t line_;
};

}  // namespace relight
