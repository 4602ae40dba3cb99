#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "core/base/result.h"
#include "core/io/text_scanner.h"

namespace relight {

/// Walks the statements of an OBJ file: one a line, which a backslash at its end continues on the
/// next line; '#' at the start of a word begins a comment, which ends with its line.
class ObjWords {
  public:
    explicit ObjWords(std::span<const std::byte> file) : scanner_(file) {}

    bool at_end() const { return scanner_.at_end(); }
    std::uint64_t line() const { return line_; }  ///< on which the statement began

    /// The first word of the statement that begins here; empty on a blank line or a comment.
    std::string_view keyword()
    {
        line_ = scanner_.line();
        return word();
    }

    /// The next word of the statement, empty at its end.
    std::string_view word()
    {
        for (;;) {
            std::string_view next = scanner_.word();
            if (next.starts_with('#')) {
                scanner_.rest_of_line();
                return {};
            }
            if (!next.ends_with('\\') || !scanner_.at_line_end()) { return next; }
            next.remove_suffix(1);
            scanner_.next_line();
            if (!next.empty() || scanner_.at_end()) { return next; }
        }
    }

    /// TextScanner's.
    bool plain_corner(std::array<std::uint32_t, 3>& numbers)
    {
        return scanner_.plain_corner(numbers);
    }

    /// What follows on the line, without blanks around it: names may contain blanks and '#'.
    std::string_view name();

    /// All numbers of the statement into `out`; how many there are. Errors: `parse_coordinate`'s,
    /// and MalformedBody if there are fewer than `least` or more than fit.
    Result<std::size_t> numbers(std::span<double> out, std::size_t least,
                                std::string_view expected);

    /// Passes over what is left of the statement, then to the next.
    void next_statement()
    {
        while (!word().empty()) {}
        scanner_.next_line();
    }

    std::size_t swapped_exponents() const
    {
        return swapped_exponents_;
    }  ///< "3.1+e2", read as 3.1e+2

    Error error(Fault fault, std::string detail) const
    {
        return {fault, std::move(detail), {}, line_, {}};
    }

  private:
    TextScanner scanner_;
    std::uint64_t line_ = 1;
    std::size_t swapped_exponents_ = 0;
};

}  // namespace relight
