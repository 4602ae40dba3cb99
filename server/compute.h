#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "core/base/progress.h"
#include "core/base/result.h"

namespace relight {

/// The few threads that compute; connection threads wait for them, and write answers while they
/// send them. Jobs start in the order they came; a queue that is full refuses at once.
class ComputePool {
  public:
    using Job = std::function<void(Progress&)>;

    ComputePool(unsigned workers, std::size_t queue);
    ComputePool(const ComputePool&) = delete;
    ComputePool& operator=(const ComputePool&) = delete;
    ~ComputePool();  ///< stops what runs, drops what waits

    /// Does `job` when its turn comes; whoever holds `progress` may stop it, before that too. False
    /// if the queue is full.
    bool submit(Job job, std::shared_ptr<Progress> progress = std::make_shared<Progress>());

    /// Runs `work(progress)`, a Result, here and waits for it; what it throws is thrown again.
    /// Errors: Overloaded if the queue is full, Stopping if it was dropped from it.
    template <class Work>
    auto run(Work work, const std::shared_ptr<Progress>& progress = std::make_shared<Progress>())
        -> std::invoke_result_t<Work, Progress&>
    {
        using Answer = std::invoke_result_t<Work, Progress&>;
        auto task = std::make_shared<std::packaged_task<Answer(Progress&)>>(std::move(work));
        auto answer = task->get_future();
        if (!submit([task](Progress& p) { (*task)(p); }, progress)) { return overloaded(); }
        task.reset();  // a job that is dropped breaks its promise, which wakes us
        try {
            return answer.get();
        } catch (const std::future_error&) {
            return dropped();
        }
    }

    /// Waits until nothing runs or waits; false if that takes longer than `time`.
    bool idle_within(std::chrono::milliseconds time);
    /// Asks what runs to stop; it ends with Cancelled.
    void stop_all();

  private:
    static Error overloaded();
    static Error dropped();
    void work();

    std::mutex mutex_;
    std::condition_variable changed_;
    struct Waiting {
        Job job;
        std::shared_ptr<Progress> progress;
    };
    std::deque<Waiting> waiting_;
    std::set<std::shared_ptr<Progress>> running_;
    std::size_t most_waiting_;
    bool closing_ = false;
    std::vector<std::jthread> workers_;
};

}  // namespace relight
