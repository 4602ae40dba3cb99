#pragma once

#include <cstddef>
#include <string_view>
#include <variant>

#include "server/http_head.h"

namespace relight {

/// Finds the end of a head that arrives in pieces; each byte is looked at once. Refuses what no
/// head may hold (control characters, CR or LF alone) and what is too long, as soon as it shows.
class HeadScanner {
  public:
    explicit HeadScanner(const HeadLimits& limits) : limits_(limits) {}

    /// `buffered` starts at the same byte each time and only grows.
    /// @return nothing yet (monostate), the whole head, or a refusal.
    std::variant<std::monostate, std::string_view, Refusal> scan(std::string_view buffered);

    /// Bytes up to the end of the head that `scan` returned.
    std::size_t size() const { return at_; }

  private:
    HeadLimits limits_;
    std::size_t at_ = 0;          // next byte to look at
    std::size_t begin_ = 0;       // of the head: one empty line before it is forgiven
    std::size_t line_begin_ = 0;  // of the line being read
    std::size_t lines_ = 0;
    bool after_cr_ = false;
};

}  // namespace relight
