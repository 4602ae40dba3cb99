#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <span>
#include <string>

#include "core/base/result.h"
#include "core/io/coordinate.h"
#include "core/io/ply_header.h"
#include "core/io/text_scanner.h"

namespace relight::ply {

static_assert(std::endian::native == std::endian::little, "binary files are read by memcpy");

/// A value as it lies in a binary file; Swap: in the other byte order.
template <class T, bool Swap>
T load(const std::byte* at)
{
    std::byte bytes[sizeof(T)];
    for (std::size_t i = 0; i < sizeof(T); ++i) { bytes[i] = at[Swap ? sizeof(T) - 1 - i : i]; }
    return std::bit_cast<T>(bytes);
}

/// Calls f with a zero of the C++ type that `type` names.
template <class F>
auto with_type(Scalar type, F&& f)
{
    switch (type) {
        case Scalar::I8:
            return f(std::int8_t{});
        case Scalar::U8:
            return f(std::uint8_t{});
        case Scalar::I16:
            return f(std::int16_t{});
        case Scalar::U16:
            return f(std::uint16_t{});
        case Scalar::I32:
            return f(std::int32_t{});
        case Scalar::U32:
            return f(std::uint32_t{});
        case Scalar::F32:
            return f(float{});
        case Scalar::F64:
            break;
    }
    return f(double{});
}

/// The values of a binary body, one after the other. Nothing is read beyond the end.
template <bool Swap>
class BinarySource {
  public:
    BinarySource(std::span<const std::byte> file, const Header& header)
        : file_(file), at_(header.body)
    {
    }

    std::size_t remaining() const { return file_.size() - at_; }
    const std::byte* data() const { return file_.data() + at_; }
    void advance(std::size_t bytes) { at_ += bytes; }

    /// The next value; nothing if the file ends.
    std::optional<double> next(Scalar type)
    {
        if (remaining() < size_of(type)) { return {}; }
        const std::byte* const at = data();
        at_ += size_of(type);
        return with_type(
            type, [at](auto zero) { return static_cast<double>(load<decltype(zero), Swap>(at)); });
    }
    bool skip(Scalar type, std::uint64_t count)
    {
        if (!can_hold(type, count)) { return false; }
        at_ += count * size_of(type);
        return true;
    }
    bool can_hold(Scalar type, std::uint64_t count) const
    {
        return count <= remaining() / size_of(type);
    }

    void begin_record() { record_ = at_; }
    bool end_record() const { return true; }

    /// Text editors like to end a file with a line feed, whatever it holds.
    bool only_blanks_follow()
    {
        begin_record();
        return std::all_of(file_.begin() + static_cast<std::ptrdiff_t>(at_), file_.end(),
                           [](std::byte b) {
                               const char c = static_cast<char>(b);
                               return TextScanner::is_blank(c) || TextScanner::is_line_end(c);
                           });
    }

    /// Why next() or end_record() said no.
    Error failure() const { return error(Fault::Truncated, "the file ends inside a record"); }
    /// An error in the record begun last.
    Error error(Fault fault, std::string detail) const
    {
        return {fault, std::move(detail), {}, {}, record_};
    }

  private:
    std::span<const std::byte> file_;
    std::size_t at_, record_ = at_;
};

/// The values of an ascii body. A record may run on over several lines, but each starts a new one,
/// so that a value too many or too few cannot shift all that follow.
class TextSource {
  public:
    TextSource(std::span<const std::byte> file, const Header& header)
        : scanner_(file, header.body, header.body_line)
    {
    }

    /// The largest double for what is larger; infinity of either sign is the positive one.
    std::optional<double> next(Scalar type)
    {
        word_ = scanner_.word_on_any_line();
        type_ = type;
        if (!is_integer(type)) { return real(word_); }
        const Number<std::int64_t> number = parse_integer(word_);
        const bool fits = number && with_type(type, [&](auto zero) {
                              using Limits = std::numeric_limits<decltype(zero)>;
                              const auto value = static_cast<double>(number.value);
                              return value >= static_cast<double>(Limits::lowest()) &&
                                     value <= static_cast<double>(Limits::max());
                          });
        if (!fits) { return {}; }
        return static_cast<double>(number.value);
    }
    bool skip(Scalar type, std::uint64_t count)
    {
        type_ = type;
        for (; count > 0; --count) {
            word_ = scanner_.word_on_any_line();
            if (word_.empty()) { return false; }
        }
        return true;
    }
    bool can_hold(Scalar, std::uint64_t count) const
    {
        return count <= (scanner_.remaining() + 1) / 2;  // a digit and a blank each
    }

    void begin_record()
    {
        while (scanner_.at_line_end() && !scanner_.at_end()) { scanner_.next_line(); }
    }
    bool end_record()
    {
        if (scanner_.at_line_end()) { return true; }
        extra_ = scanner_.word();
        return false;
    }

    Error failure() const
    {
        if (!extra_.empty()) {
            return error(Fault::MalformedBody,
                         "the record is complete, but its line goes on with " + shown(extra_) +
                             ": each record needs a line of its own");
        }
        if (word_.empty()) {
            return error(Fault::Truncated, "the file ends before all announced records");
        }
        return error(Fault::MalformedBody,
                     shown(word_) + " is not a value of type " + std::string(name_of(type_)));
    }
    Error error(Fault fault, std::string detail) const
    {
        return scanner_.error(fault, std::move(detail));
    }

    bool only_blanks_follow() { return scanner_.word_on_any_line().empty(); }

  private:
    static std::optional<double> real(std::string_view word)
    {
        const Number<double> number = parse_real(word);
        switch (number.kind) {
            case NumberKind::Ok:
                return number.value;
            case NumberKind::Malformed:
                return {};
            case NumberKind::OutOfRange:
                return std::numeric_limits<double>::max();
            case NumberKind::NonFinite:
                break;
        }
        using Limits = std::numeric_limits<double>;
        return says_nan(word) ? Limits::quiet_NaN() : Limits::infinity();
    }

    TextScanner scanner_;
    std::string_view word_, extra_;
    Scalar type_{};
};

}  // namespace relight::ply
