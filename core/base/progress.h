#pragma once

#include <atomic>
#include <cstdint>

namespace relight {

/// Passed into long work: it asks `stopped()` once a block and says how far it is. Who asked, and
/// how the answer travels, is the caller's business.
class Progress {
  public:
    void stop() { stopped_.store(true, std::memory_order_relaxed); }
    bool stopped() const { return stopped_.load(std::memory_order_relaxed); }

    /// `total` more units of work lie ahead / `n` of them are done.
    void expect(std::uint64_t total) { total_.fetch_add(total, std::memory_order_relaxed); }
    void advance(std::uint64_t n) { done_.fetch_add(n, std::memory_order_relaxed); }

    /// Share done, 0..1.
    double fraction() const
    {
        const auto total = total_.load(std::memory_order_relaxed);
        const auto done = done_.load(std::memory_order_relaxed);
        return total == 0 ? 0.0 : static_cast<double>(done) / static_cast<double>(total);
    }

  private:
    std::atomic<bool> stopped_{false};
    std::atomic<std::uint64_t> total_{0}, done_{0};
};

}  // namespace relight
