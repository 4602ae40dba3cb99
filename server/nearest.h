#pragma once

#include <span>
#include <string>
#include <string_view>

namespace relight {

/// The word nearest to `name` if it is near enough to be what was meant, else empty.
std::string_view nearest(std::string_view name, std::span<const std::string> words);

}  // namespace relight
