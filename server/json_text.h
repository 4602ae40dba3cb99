#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/vec.h"

namespace relight {

/// Appends a JSON string. Bytes that are not UTF-8 (a name out of a file) become U+FFFD, so that
/// what we send is always JSON.
void append_quoted(std::string& out, std::string_view text);
std::string json_string(std::string_view text);

/// The shortest decimal that reads back exactly. `value` is finite.
std::string decimal(double value);

/// "[x,y,z]"
std::string json_of(Vec3 v);

/// ["…",…]
std::string text_array(const std::vector<std::string>& texts);

/// Text of a client's for a message: printable ASCII, the rest as '?', cut after `longest`.
std::string printable(std::string_view text, std::size_t longest = 64);

/// Builds one JSON object, field after field; commas are its business.
class ObjectWriter {
  public:
    ObjectWriter& raw(std::string_view name, std::string_view json);
    ObjectWriter& text(std::string_view name, std::string_view value)
    {
        return raw(name, json_string(value));
    }
    ObjectWriter& number(std::string_view name, double value) { return raw(name, decimal(value)); }
    ObjectWriter& count(std::string_view name, std::uint64_t value)
    {
        return raw(name, std::to_string(value));
    }
    ObjectWriter& flag(std::string_view name, bool value)
    {
        return raw(name, value ? "true" : "false");
    }
    std::string done()
    {
        json_ += '}';
        return std::move(json_);
    }

  private:
    std::string json_ = "{";
};

}  // namespace relight
