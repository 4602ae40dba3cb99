#include "server/server_log.h"

#include <array>
#include <chrono>
#include <cstdio>
#include <ctime>

#include "server/json_text.h"

namespace relight {
namespace {

/// RFC 3339, UTC, milliseconds.
std::string now()
{
    const auto since = std::chrono::system_clock::now().time_since_epoch();
    const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(since).count();
    const std::time_t seconds = ms / 1000;
    std::tm utc = {};
    gmtime_r(&seconds, &utc);
    std::array<char, 40> text{};
    const std::size_t length = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &utc);
    std::snprintf(text.data() + length, text.size() - length, ".%03dZ",
                  static_cast<int>(ms % 1000));
    return text.data();
}

}  // namespace

void Log::line(const std::string& text)
{
    const std::lock_guard lock(mutex_);
    std::fwrite(text.data(), 1, text.size(), stderr);
}

void Log::access(const AccessEntry& entry) noexcept
{
    try {
        const std::string path = printable(entry.path, 512);
        if (as_json_) {
            line(ObjectWriter()
                     .text("time", now())
                     .text("client", entry.client)
                     .text("method", entry.method)
                     .text("path", path)
                     .count("status", static_cast<std::uint64_t>(entry.status))
                     .count("bytes", entry.bytes)
                     .number("ms", entry.milliseconds)
                     .done() +
                 "\n");
        } else {
            line(now() + ' ' + std::string(entry.client) + ' ' + printable(entry.method) + ' ' +
                 path + ' ' + std::to_string(entry.status) + ' ' + std::to_string(entry.bytes) +
                 "B " + decimal(entry.milliseconds) + "ms\n");
        }
    } catch (...) {  // a log that fails must not take a connection with it
        return;
    }
}

void Log::message(std::string_view text) noexcept
{
    try {
        line(as_json_ ? ObjectWriter().text("time", now()).text("message", text).done() + "\n"
                      : now() + ' ' + printable(text, 1024) + "\n");
    } catch (...) {
        return;
    }
}

}  // namespace relight
