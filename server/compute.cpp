#include "server/compute.h"

namespace relight {

ComputePool::ComputePool(unsigned workers, std::size_t queue) : most_waiting_(queue)
{
    workers_.reserve(workers);
    for (unsigned i = 0; i < workers; ++i) {
        workers_.emplace_back([this] { work(); });
    }
}

ComputePool::~ComputePool()
{
    stop_all();
    const std::lock_guard lock(mutex_);
    closing_ = true;
    waiting_.clear();
    changed_.notify_all();
}  // the workers, declared last, are joined when the lock is gone

Error ComputePool::overloaded()
{
    return {Fault::Overloaded,
            "every worker is busy and the queue is full (limit --queue); try again "
            "after the time in Retry-After",
            {},
            {},
            {}};
}

Error ComputePool::dropped()
{
    return {Fault::Stopping, "the server is stopping; send it again later", {}, {}, {}};
}

bool ComputePool::submit(Job job, std::shared_ptr<Progress> progress)
{
    const std::lock_guard lock(mutex_);
    if (waiting_.size() >= most_waiting_ + (workers_.size() - running_.size())) { return false; }
    waiting_.push_back({std::move(job), std::move(progress)});
    changed_.notify_all();
    return true;
}

void ComputePool::work()
{
    std::unique_lock lock(mutex_);
    while (true) {
        changed_.wait(lock, [&] { return closing_ || !waiting_.empty(); });
        if (closing_) { return; }
        auto [job, progress] = std::move(waiting_.front());
        waiting_.pop_front();
        running_.insert(progress);
        lock.unlock();
        job(*progress);
        job = nullptr;  // what it holds goes before we count as idle
        lock.lock();
        running_.erase(progress);
        changed_.notify_all();
    }
}

bool ComputePool::idle_within(std::chrono::milliseconds time)
{
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, time, [&] { return running_.empty() && waiting_.empty(); });
}

void ComputePool::stop_all()
{
    const std::lock_guard lock(mutex_);
    waiting_.clear();
    for (const auto& progress : running_) { progress->stop(); }
}

}  // namespace relight
