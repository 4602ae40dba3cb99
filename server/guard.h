#pragma once

#include <httplib.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <string_view>

#include "server/guard_limits.h"
#include "server/http_head.h"

namespace relight {

class GuardedStream;

/// The problem+json body of an answer the guard gives itself: status, what is wrong, in words.
using ProblemBody = std::function<std::string(int, Fault, const std::string&)>;

/// The library's server behind a connection of our own, which a bare port needs: heads are read
/// whole and strictly, bodies counted, slow peers left, places bounded. What a handler may rely on:
/// - Uploads need content-reader routes; a plain Post, Put, Patch or Delete route is never reached.
/// - `content_reader(receiver)` gives the raw body, multipart included (its type then starts with a
///   capital M); when it returns false, return: the guard has the right answer and sends it.
/// - Range is ignored; the client's Accept-Encoding is in `accept_encoding_field`.
/// - Exceptions become a 500 without their text.
class GuardedServer : public httplib::Server {
  public:
    GuardedServer(GuardLimits limits, ProblemBody problem_body);
    ~GuardedServer() override;
    GuardedServer(const GuardedServer&) = delete;
    GuardedServer& operator=(const GuardedServer&) = delete;

    /// @param port 0: a free one
    /// @return the port, or -1 (taken, or not ours to take)
    int bind(const std::string& host, int port);
    /// Serves until `drain`, then returns once every connection has ended. Register routes before:
    /// it adds a 404 for what no content-reader route takes. False: the port could not be used.
    bool run();
    /// Graceful stop, from another thread: each running request gets its answer, the last on its
    /// connection; idle connections end. New ones are still answered meanwhile, so that /readyz can
    /// say 503. When nothing runs any more, or after `patience`, all that is left is cut off.
    /// @return whether all requests were answered; if not, end the handlers' work: `run` waits.
    bool drain(std::chrono::milliseconds patience);

    bool draining() const { return draining_; }
    std::size_t open_connections() const;
    const GuardLimits& limits() const { return limits_; }

  private:
    struct Connection {
        std::string ip;
        bool running = false;  // between a request's head and the end of its answer
    };

    void accept_connections();
    bool admit(int fd, const std::string& ip);
    bool start_thread(int fd);
    void turn_away(int fd);
    bool process_and_close_socket(socket_t fd) override;
    void serve(int fd);
    bool wait_for_request(GuardedStream& stream) const;
    bool serve_request(GuardedStream& stream, bool keep);
    bool set_running(int fd, bool running);
    void release(int fd);
    std::chrono::milliseconds idle_time() const;
    std::string answer(const Refusal& refusal) const;

    GuardLimits limits_;
    ProblemBody problem_body_;
    std::atomic<bool> draining_ = false;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    bool closed_ = false;                    // the listener
    std::map<int, Connection> connections_;  // by descriptor
};

}  // namespace relight
