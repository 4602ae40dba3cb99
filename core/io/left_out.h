#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "core/io/text_scanner.h"

namespace relight {

/// Names of what a reader passed over, the first few of them, for a note.
class LeftOut {
  public:
    void add(std::string_view name)
    {
        constexpr std::size_t most = 8;
        if (++count_ <= most) {
            names_ += (count_ > 1 ? ", " : "") + shown(name);
        } else if (count_ == most + 1) {
            names_ += ", …";
        }
    }
    bool any() const { return count_ > 0; }
    const std::string& names() const { return names_; }

  private:
    std::size_t count_ = 0;
    std::string names_;
};

}  // namespace relight
