#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "server/guard_limits.h"
#include "server/relight.h"

namespace relight {

/// What the command line and RELIGHT_… of the environment say.
struct Options {
    std::string host = "127.0.0.1";
    int port = 8080;  ///< 0: a free one
    std::string store = "relight-store";
    unsigned threads = 0;                ///< of one job; 0: one a core
    unsigned workers = 2;                ///< jobs at once
    std::size_t queue = 64;              ///< jobs that may wait
    std::uint64_t memory = 2ULL << 30U;  ///< bytes of the cache, and of one job's working arrays
    bool log_json = false;
    std::uint64_t max_upload_bytes = 1ULL << 30U;
    std::uint64_t max_json_bytes = 16ULL << 20U;
    std::uint64_t max_inflight_bytes = 4ULL << 30U;  ///< of all bodies that are arriving
    std::uint64_t max_rays = 4'000'000'000;          ///< of one job
    ParseLimits parse;
    GuardLimits guard;
};

/// Reads them; a number instead says that the program should end with it (--help, a mistake).
struct ParsedOptions {
    Options options;
    std::optional<int> exit_code;
};
ParsedOptions parse_options(int argc, const char* const* argv);

/// The limits as JSON, for /readyz; names are the flags' with '_' for '-'.
std::string limits_json(const Options& options);

}  // namespace relight
