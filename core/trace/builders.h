#pragma once

#include <condition_variable>
#include <functional>
#include <future>
#include <mutex>
#include <queue>
#include <thread>
#include <vector>

#include "core/base/progress.h"

namespace relight {

/// Threads for work that cannot be stopped at once, so that who asked for it can go. They are kept:
/// Embree and TBB hold some hundred bytes for every thread that ever built, until the end.
class Builders {
  public:
    Builders() = default;
    Builders(const Builders&) = delete;
    Builders& operator=(const Builders&) = delete;
    ~Builders();  ///< waits for all work

    /// Waits for work() and throws what it throws; true then. False within milliseconds of
    /// progress being stopped: then work, if it was begun, goes on behind the caller, and should
    /// own all that it touches; that is let go when it ends. New work waits for what was left
    /// behind: so no more memory is at work for nobody than was at work at once.
    bool run(const std::function<void()>& work, const Progress& progress);

  private:
    using Task = std::packaged_task<void()>;

    void begin(Task&& task);
    void serve();
    bool any_left_behind();

    std::mutex mutex_;
    std::condition_variable changed_;
    std::queue<Task> waiting_;
    std::vector<std::future<void>> left_behind_;
    std::size_t idle_ = 0;
    bool ending_ = false;
    std::vector<std::thread> threads_;
};

}  // namespace relight
