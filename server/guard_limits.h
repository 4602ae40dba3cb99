#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "server/http_head.h"

namespace relight {

/// What one client, and all together, may ask of the connection; each value can be a flag.
struct GuardLimits {
    HeadLimits head;                              ///< sizes, see there
    std::chrono::milliseconds head_time{10'000};  ///< for a head, from its first byte: then 408
    std::chrono::milliseconds idle_time{15'000};  ///< between requests, and before the first
    std::chrono::milliseconds busy_idle_time{
        1'000};  ///< the same when over half the places are taken

    std::uint64_t body_bytes = std::uint64_t{512} << 20;  ///< a request's body: beyond it 413
    double least_rate = 1024.0;               ///< bytes/s a body comes and an answer goes …
    std::chrono::milliseconds grace{10'000};  ///< … but for pauses that add up to this: 408
    std::chrono::milliseconds transfer_time{
        600'000};  ///< waiting for a body, or for an answer's reader

    std::size_t connections = 2048;              ///< at once, a thread each: beyond it 503
    std::size_t connections_per_address = 1536;  ///< from one address, which may be a proxy
    std::size_t requests_per_connection = 1000;  ///< then it closes after the answer
};

}  // namespace relight
