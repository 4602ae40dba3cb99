#include "core/trace/builders.h"

#include <chrono>
#include <memory>
#include <utility>

namespace relight {
namespace {

constexpr std::chrono::milliseconds between_looks{2};

bool is_done(const std::future<void>& done)
{
    return done.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

}  // namespace

Builders::~Builders()
{
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
    }
    changed_.notify_all();
    for (std::thread& thread : threads_) { thread.join(); }
}

bool Builders::run(const std::function<void()>& work, const Progress& progress)
{
    while (any_left_behind() && !progress.stopped()) { std::this_thread::sleep_for(between_looks); }
    if (progress.stopped()) { return false; }
    // Its future may be kept for long: the work, and what it owns, go when it has ended.
    const auto own = std::make_shared<std::function<void()>>(work);
    Task task([own] { std::exchange(*own, nullptr)(); });
    std::future<void> done = task.get_future();
    begin(std::move(task));
    while (done.wait_for(between_looks) != std::future_status::ready) {
        if (!progress.stopped()) { continue; }
        const std::lock_guard lock(mutex_);
        left_behind_.push_back(std::move(done));
        return false;
    }
    done.get();
    return true;
}

void Builders::begin(Task&& task)
{
    {
        const std::lock_guard lock(mutex_);
        if (idle_ <= waiting_.size()) {
            threads_.emplace_back([this] { serve(); });
        }
        waiting_.push(std::move(task));
    }
    changed_.notify_one();
}

void Builders::serve()
{
    std::unique_lock lock(mutex_);
    while (true) {
        ++idle_;
        changed_.wait(lock, [this] { return ending_ || !waiting_.empty(); });
        --idle_;
        if (waiting_.empty()) { return; }
        Task task = std::move(waiting_.front());
        waiting_.pop();
        lock.unlock();
        task();
        lock.lock();
    }
}

bool Builders::any_left_behind()
{
    const std::lock_guard lock(mutex_);
    std::erase_if(left_behind_, is_done);
    return !left_behind_.empty();
}

}  // namespace relight
