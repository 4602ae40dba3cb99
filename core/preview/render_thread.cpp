#include "core/preview/render_thread.h"

#include <condition_variable>
#include <deque>
#include <future>
#include <mutex>
#include <thread>

namespace relight {
namespace {

class RenderThread {
  public:
    RenderThread()
    {
        std::thread([this] { serve(); }).detach();
    }

    void run(const std::function<void()>& work)
    {
        std::packaged_task<void()> task(work);
        std::future<void> done = task.get_future();
        {
            const std::lock_guard lock(mutex_);
            waiting_.push_back(std::move(task));
        }
        wake_.notify_one();
        done.get();
    }

  private:
    [[noreturn]] void serve()
    {
        for (;;) {
            std::unique_lock lock(mutex_);
            wake_.wait(lock, [this] { return !waiting_.empty(); });
            std::packaged_task<void()> task = std::move(waiting_.front());
            waiting_.pop_front();
            lock.unlock();
            task();
        }
    }

    std::mutex mutex_;
    std::condition_variable wake_;
    std::deque<std::packaged_task<void()>> waiting_;
};

}  // namespace

void on_render_thread(const std::function<void()>& work)
{
    // Lives until the process ends, never destroyed: a context torn down while the driver's own
    // exit handlers run is a crash at shutdown.
    static RenderThread& thread = *new RenderThread;  // NOLINT
    thread.run(work);
}

}  // namespace relight
