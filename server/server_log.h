#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>

namespace relight {

/// What the access log says of one request.
struct AccessEntry {
    std::string_view client, method, path;  ///< the client's words: escaped before they are written
    int status{};
    std::uint64_t bytes{};
    double milliseconds{};
};

/// Lines on standard error, as text or as JSON. Any thread may call; nothing is thrown.
class Log {
  public:
    explicit Log(bool as_json) : as_json_(as_json) {}
    void access(const AccessEntry& entry) noexcept;
    void message(std::string_view text) noexcept;

  private:
    void line(const std::string& text);

    bool as_json_;
    std::mutex mutex_;
};

}  // namespace relight
