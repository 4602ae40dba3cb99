#pragma once

#include <exception>
#include <functional>
#include <semaphore>
#include <string_view>
#include <thread>
#include <utility>

namespace relight {

/// Takes the next bytes of an answer; the view ends with the call. False: the receiver is gone.
using Sink = std::function<bool(std::string_view)>;

/// Calls a sink on a thread of its own, in order, so that the next bytes can be made meanwhile.
class Sender {
  public:
    explicit Sender(const Sink& sink) : sink_(sink), thread_([this] { run(); }) {}
    Sender(const Sender&) = delete;
    Sender& operator=(const Sender&) = delete;
    ~Sender()
    {
        if (sending_) { sent_.acquire(); }
        bytes_ = {};
        due_.release();
        thread_.join();
    }

    /// Has bytes sent, at least one, which stay as they are until the next call. False: the sink
    /// has refused what came before, and is not called any more.
    bool send(std::string_view bytes)
    {
        if (!wait()) { return false; }
        bytes_ = bytes;
        sending_ = true;
        due_.release();
        return true;
    }

    /// Until all is sent. False: the sink has refused it. What it threw is thrown here.
    bool wait()
    {
        if (std::exchange(sending_, false)) {
            sent_.acquire();
            if (thrown_) { std::rethrow_exception(std::exchange(thrown_, nullptr)); }
        }
        return open_;
    }

  private:
    void run()
    {
        for (due_.acquire(); !bytes_.empty(); due_.acquire()) {
            try {
                open_ = sink_(bytes_);
            } catch (...) {
                open_ = false;
                thrown_ = std::current_exception();
            }
            sent_.release();
        }
    }

    const Sink& sink_;
    std::binary_semaphore due_{0}, sent_{0};
    // The thread's between due_ and sent_, else the caller's.
    std::string_view bytes_;  // none: the end
    bool open_ = true;
    std::exception_ptr thrown_;
    bool sending_ = false;  // the caller's
    std::thread thread_;    // last: it uses the others
};

}  // namespace relight
