#pragma once

#include <atomic>
#include <cstdint>

namespace relight {

/// Bytes that all connections together may hold at once.
class ByteBudget {
  public:
    explicit ByteBudget(std::uint64_t bytes) : most_(bytes) {}

    /// One connection's share; given back with it.
    class Share {
      public:
        explicit Share(ByteBudget& budget) : budget_(budget) {}
        Share(const Share&) = delete;
        Share& operator=(const Share&) = delete;
        ~Share() { budget_.held_ -= held_; }

        /// False if that is more than there is.
        bool grow(std::uint64_t bytes)
        {
            held_ += bytes;
            return (budget_.held_ += bytes) <= budget_.most_;
        }

      private:
        ByteBudget& budget_;
        std::uint64_t held_ = 0;
    };

  private:
    std::uint64_t most_;
    std::atomic<std::uint64_t> held_{0};
};

}  // namespace relight
