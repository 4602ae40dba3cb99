#include "server/patience.h"

#include <poll.h>

#include <algorithm>
#include <cerrno>

namespace relight {

bool Patience::wait(int fd, short events)
{
    const auto start = std::chrono::steady_clock::now();
    const double most = std::min(left_, total_).count();  // [s]
    pollfd watched{fd, events, 0};
    const int ready = most <= 0.0 ? 0 : poll(&watched, 1, 1 + static_cast<int>(1000.0 * most));
    const Duration waited = std::chrono::steady_clock::now() - start;
    left_ -= waited;
    total_ -= waited;
    // A signal is no reason to give up; the caller tries again and comes back with less patience.
    return ready > 0 || (ready < 0 && errno == EINTR);
}

void Patience::earn(std::size_t bytes)
{
    if (rate_ > 0.0) {
        left_ = std::min(grace_, left_ + Duration(static_cast<double>(bytes) / rate_));
    }
}

}  // namespace relight
