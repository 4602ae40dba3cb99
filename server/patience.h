#pragma once

#include <chrono>
#include <cstddef>

namespace relight {

/// How long a peer may keep us waiting. Waiting spends the patience, bytes earn it back at
/// 1 s per `rate` bytes, never above its start: so a steady peer at `rate` lasts, and a stalled
/// one is left after `grace`, however much it moved before. `total` is never earned back.
class Patience {
  public:
    using Duration = std::chrono::duration<double>;  // [s]
    /// @param rate bytes/s; 0: nothing is earned
    Patience(Duration grace, Duration total, double rate)
        : grace_(grace), left_(grace), total_(total), rate_(rate)
    {
    }
    /// Waits until the socket is ready for `events` (poll's). False: the patience has run out.
    bool wait(int fd, short events);
    void earn(std::size_t bytes);

  private:
    Duration grace_, left_, total_;
    double rate_;
};

}  // namespace relight
