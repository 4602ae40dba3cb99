#pragma once

#include <chrono>

#include "core/base/result.h"
#include "server/json_tree.h"

namespace relight {

/// Adds the milliseconds of `work` to `ms`; returns what it returns.
template <class Work>
auto timed(double& ms, Work&& work)
{
    using Clock = std::chrono::steady_clock;
    struct Stopwatch {
        double& ms;
        Clock::time_point start = Clock::now();
        ~Stopwatch()
        {
            ms += std::chrono::duration<double, std::milli>(Clock::now() - start).count();
        }
    };
    const Stopwatch stopwatch{ms};
    return work();
}

/// What becomes of work that was stopped.
inline Error cancelled()
{
    return make_error(Fault::Cancelled, "the server is stopping; send it again later");
}

}  // namespace relight
