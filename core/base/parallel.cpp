#include "core/base/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace relight {
namespace {

/// Denormal results are flushed to zero while this lives: they cost a hundred cycles each.
class FlushDenormals {
  public:
#if defined(__SSE2__)
    FlushDenormals() : before_(_mm_getcsr())
    {
        _mm_setcsr(before_ | 0x8040U);
    }
    ~FlushDenormals()
    {
        _mm_setcsr(before_);
    }
#else
    FlushDenormals() = default;
    ~FlushDenormals() = default;
#endif
    FlushDenormals(const FlushDenormals&) = delete;
    FlushDenormals& operator=(const FlushDenormals&) = delete;

  private:
#if defined(__SSE2__)
    unsigned before_;
#endif
};

}  // namespace

void parallel_for(std::size_t count, std::size_t block, unsigned threads, Progress& progress,
                  const std::function<void(std::size_t, std::size_t)>& body)
{
    const std::size_t blocks = (count + block - 1) / block;
    std::atomic<std::size_t> next{0};
    std::exception_ptr failure;
    std::mutex failure_mutex;
    const auto work = [&] {
        const FlushDenormals flush;
        try {
            for (std::size_t i = next++; i < blocks && !progress.stopped(); i = next++) {
                body(i * block, std::min(count, (i + 1) * block));
            }
        } catch (...) {
            const std::lock_guard lock(failure_mutex);
            if (!failure) { failure = std::current_exception(); }
            next = blocks;
        }
    };
    const unsigned wanted =
        threads == 0 ? std::max(1U, std::thread::hardware_concurrency()) : threads;
    const std::size_t helpers = std::min<std::size_t>(wanted, blocks) - (blocks == 0 ? 0 : 1);
    {
        std::vector<std::jthread> pool;
        pool.reserve(helpers);
        for (std::size_t i = 0; i < helpers; ++i) { pool.emplace_back(work); }
        work();
    }
    if (failure) { std::rethrow_exception(failure); }
}

}  // namespace relight
