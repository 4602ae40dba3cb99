#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/io/text_scanner.h"

namespace relight {

/// Walks the rows of a table in text: fields between blanks, or between blanks with one comma or
/// semicolon among them; '#' and "//" begin a comment. Two separators without anything between them
/// hold an empty field; one at the end of a line does not.
class RowScanner {
  public:
    /// More fields than any layout has are not told apart: a row has at most one more than this.
    static constexpr std::size_t most_fields = 100;

    explicit RowScanner(std::span<const std::byte> file) : scanner_(file) {}

    /// The fields of the next line that has any, until the next call; none at the end of the file.
    std::span<const std::string_view> next()
    {
        do {
            line_ = scanner_.line();
            fields_.clear();
            if (scanner_.at_end()) { break; }
            split(scanner_.rest_of_line());
            scanner_.next_line();
        } while (fields_.empty());
        return fields_;
    }

    std::uint64_t line() const { return line_; }  ///< of that row, or of the end of the file
    std::size_t remaining() const { return scanner_.remaining(); }
    std::string_view comment() const { return comment_; }  ///< the last that had a line of its own

  private:
    static bool is_separator(char c) { return c == ',' || c == ';'; }

    void split(std::string_view text)
    {
        const char* at = text.data();
        const char* const end = at + text.size();
        const auto skip_blanks = [&] {
            while (at != end && TextScanner::is_blank(*at)) { ++at; }
        };
        for (skip_blanks(); at != end && fields_.size() <= most_fields; skip_blanks()) {
            if (*at == '#' || (*at == '/' && end - at > 1 && at[1] == '/')) {
                if (fields_.empty()) { comment_ = {at, static_cast<std::size_t>(end - at)}; }
                return;
            }
            const char* const start = at;
            while (at != end && !TextScanner::is_blank(*at) && !is_separator(*at)) { ++at; }
            fields_.emplace_back(start, static_cast<std::size_t>(at - start));
            skip_blanks();
            if (at != end && is_separator(*at)) { ++at; }
        }
    }

    TextScanner scanner_;
    std::uint64_t line_ = 1;
    std::vector<std::string_view> fields_;
    std::string_view comment_;
};

}  // namespace relight
