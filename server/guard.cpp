#include "server/guard.h"

#include <pthread.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <memory>
#include <new>
#include <thread>

#include "server/guarded_stream.h"

namespace relight {
namespace {

constexpr int backlog = 1024;  // the library's is 5
constexpr std::size_t stack_bytes = std::size_t{1}
                                    << 20;              // a connection's; only touched pages count
constexpr std::size_t other_descriptors = 128;          // files, listener, libraries
constexpr std::chrono::milliseconds idle_slice{1'000};  // an idle connection looks up this often

std::string_view reason(int status)
{
    switch (status) {
        case 400:
            return "Bad Request";
        case 404:
            return "Not Found";
        case 408:
            return "Request Timeout";
        case 411:
            return "Length Required";
        case 413:
            return "Payload Too Large";
        case 414:
            return "URI Too Long";
        case 415:
            return "Unsupported Media Type";
        case 417:
            return "Expectation Failed";
        case 431:
            return "Request Header Fields Too Large";
        case 500:
            return "Internal Server Error";
        case 501:
            return "Not Implemented";
        case 503:
            return "Service Unavailable";
        case 505:
            return "HTTP Version Not Supported";
        default:
            return "Refused";
    }
}

const Refusal internal_error{500, Fault::Internal, "something failed here; the log has more"};

/// As many descriptors as we could use and the system allows. @return that number
std::size_t raise_descriptor_limit()
{
    constexpr rlim_t enough = 65536;
    rlimit limit{};
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0) { return 1024; }
    limit.rlim_cur = std::max(limit.rlim_cur, std::min(limit.rlim_max, enough));
    setrlimit(RLIMIT_NOFILE, &limit);
    getrlimit(RLIMIT_NOFILE, &limit);
    return static_cast<std::size_t>(limit.rlim_cur);
}

}  // namespace

GuardedServer::GuardedServer(GuardLimits limits, ProblemBody problem_body)
    : limits_(limits), problem_body_(std::move(problem_body))
{
    // SO_REUSEPORT, the library's choice, would let two servers share a port unawares.
    set_socket_options([](socket_t fd) {
        const int yes = 1;
        setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    set_tcp_nodelay(true);
    set_keep_alive_timeout(
        std::chrono::duration_cast<std::chrono::seconds>(limits.idle_time).count());
    set_keep_alive_max_count(limits.requests_per_connection);
    set_exception_handler([this](const httplib::Request&, httplib::Response& response,
                                 const std::exception_ptr&) {  // its text is not for clients
        response.status = internal_error.status;
        response.set_content(
            problem_body_(internal_error.status, internal_error.fault, internal_error.detail),
            "application/problem+json");
    });
}

GuardedServer::~GuardedServer()
{
    const int fd = svr_sock_.exchange(INVALID_SOCKET);
    if (fd != INVALID_SOCKET) { close(fd); }
}

int GuardedServer::bind(const std::string& host, int port)
{
    const int bound = port == 0 ? bind_to_any_port(host) : bind_to_port(host, port) ? port : -1;
    // Again, for the backlog: the system queues connections from now on, before anyone accepts.
    return bound >= 0 && ::listen(svr_sock_, backlog) == 0 ? bound : -1;
}

bool GuardedServer::run()
{
    if (svr_sock_ == INVALID_SOCKET) { return false; }
    // The library would read what no content-reader route takes into memory, and its parts too.
    const auto unknown = [this](const auto&, httplib::Response& response, const auto&) {
        response.status = 404;
        response.set_content(problem_body_(404, Fault::NotFound, "there is nothing at this path"),
                             "application/problem+json");
    };
    Post(".*", unknown);
    Put(".*", unknown);
    Patch(".*", unknown);
    Delete(".*", unknown);
    const std::size_t descriptors = raise_descriptor_limit();
    limits_.connections =
        std::min(limits_.connections, descriptors - std::min(descriptors / 2, other_descriptors));
    accept_connections();
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return connections_.empty(); });
    return closed_;
}

void GuardedServer::accept_connections()
{
    for (;;) {
        sockaddr_storage address{};
        socklen_t size = sizeof address;
        const int fd = accept4(svr_sock_, reinterpret_cast<sockaddr*>(&address), &size,
                               SOCK_NONBLOCK | SOCK_CLOEXEC);
        if (fd >= 0) {
            try {
                const bool admitted = admit(fd, numeric_address(address, size).ip);
                if (!admitted || !start_thread(fd)) { turn_away(fd); }
            } catch (const std::bad_alloc&) {
                release(fd);
            }
            continue;
        }
        const int error = errno;
        {
            const std::lock_guard lock(mutex_);
            if (closed_ || error == EBADF || error == ENOTSOCK) { return; }
        }
        // Out of something: connections end, so it passes. Anything else was one client's trouble.
        if (error == EMFILE || error == ENFILE || error == ENOBUFS || error == ENOMEM) {
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
    }
}

/// Whether there is room for one more, in all and from this address; if so it is counted.
bool GuardedServer::admit(int fd, const std::string& ip)
{
    const std::lock_guard lock(mutex_);
    const auto same = [&](const auto& entry) { return entry.second.ip == ip; };
    if (closed_ || connections_.size() >= limits_.connections ||
        static_cast<std::size_t>(std::count_if(connections_.begin(), connections_.end(), same)) >=
            limits_.connections_per_address) {
        return false;
    }
    connections_[fd] = {ip};
    return true;
}

bool GuardedServer::start_thread(int fd)
{
    struct Start {
        GuardedServer& server;
        int fd;
    };
    auto start = std::make_unique<Start>(Start{*this, fd});
    const auto body = [](void* given) -> void* {
        const std::unique_ptr<Start> begun(static_cast<Start*>(given));
        begun->server.process_and_close_socket(begun->fd);
        return nullptr;
    };
    pthread_attr_t attributes;
    pthread_attr_init(&attributes);
    pthread_attr_setstacksize(&attributes, stack_bytes);  // std::thread has no say in this
    pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
    pthread_t thread{};
    const bool started = pthread_create(&thread, &attributes, body, start.get()) == 0;
    pthread_attr_destroy(&attributes);
    if (started) { start.release(); }  // NOLINT(bugprone-unused-return-value): the thread owns it
    return started;
}

/// 503 without a thread and without waiting.
void GuardedServer::turn_away(int fd)
{
    const std::string text = answer({503, Fault::Overloaded, "all connections are taken"});
    std::array<char, 16384> unread;  // read, or closing would reset the connection
    recv(fd, unread.data(), unread.size(), MSG_DONTWAIT);
    send(fd, text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    shutdown(fd, SHUT_WR);
    release(fd);
}

/// The library's hook; here it runs on the connection's own thread.
bool GuardedServer::process_and_close_socket(socket_t fd)
{
    try {
        serve(fd);
    } catch (...) {  // nothing of one connection may end the process
    }
    release(fd);
    return true;
}

void GuardedServer::serve(int fd)
{
    GuardedStream stream(fd, limits_, draining_);
    for (std::size_t requests = 1; wait_for_request(stream); ++requests) {
        if (const auto refusal = stream.read_head()) {
            if (refusal->status != 0 && stream.send_all(answer(*refusal))) { stream.linger(); }
            return;
        }
        if (!set_running(fd, true)) { return; }
        const bool keep = stream.head().keep_alive && requests < limits_.requests_per_connection;
        const bool kept = serve_request(stream, keep);
        set_running(fd, false);
        if (stream.body_pending()) {  // what comes next is no request
            stream.linger();
            return;
        }
        if (!kept || draining_) { return; }
    }
}

/// Waits between requests; false: too long.
bool GuardedServer::wait_for_request(GuardedStream& stream) const
{
    const auto since = std::chrono::steady_clock::now();
    while (!stream.wait_for_input(std::min(idle_slice, idle_time()))) {
        if (std::chrono::steady_clock::now() - since >= idle_time()) { return false; }
    }
    return true;
}

/// Answers the request whose head has just been read. @return whether another may follow
bool GuardedServer::serve_request(GuardedStream& stream, bool keep)
{
    bool done = false;
    try {
        bool library_would_close = false;  // it knows less than the head
        done = process_request(stream, !keep, library_would_close, nullptr);
    } catch (...) {  // from a content provider or the logger: outside the library's own try
        done = false;
    }
    if (!stream.answered()) {
        const Refusal refusal = stream.refusal().value_or(internal_error);
        if (refusal.status != 0) { stream.send_all(answer(refusal)); }
        return false;
    }
    return done && keep;
}

bool GuardedServer::drain(std::chrono::milliseconds patience)
{
    std::unique_lock lock(mutex_);
    draining_ = true;
    for (const auto& [fd, connection] : connections_) {
        if (!connection.running) { shutdown(fd, SHUT_RD); }  // wakes it; what has come is answered
    }
    const auto idle = [this] {
        return std::none_of(connections_.begin(), connections_.end(),
                            [](const auto& entry) { return entry.second.running; });
    };
    const bool finished = changed_.wait_for(lock, patience, idle);
    closed_ = true;
    if (svr_sock_ != INVALID_SOCKET) { shutdown(svr_sock_, SHUT_RDWR); }  // ends accept4()
    for (const auto& [fd, connection] : connections_) { shutdown(fd, SHUT_RDWR); }
    return finished;
}

std::size_t GuardedServer::open_connections() const
{
    const std::lock_guard lock(mutex_);
    return connections_.size();
}

std::chrono::milliseconds GuardedServer::idle_time() const
{
    return open_connections() > limits_.connections / 2 ? limits_.busy_idle_time
                                                        : limits_.idle_time;
}

/// @return false if the server has closed meanwhile
bool GuardedServer::set_running(int fd, bool running)
{
    const std::lock_guard lock(mutex_);
    connections_[fd].running = running && !closed_;
    changed_.notify_all();
    return !closed_;
}

void GuardedServer::release(int fd)
{
    const std::lock_guard lock(mutex_);
    connections_.erase(fd);
    close(fd);  // under the lock: the number may be given out again at once
    changed_.notify_all();
}

/// A whole response for a refusal.
std::string GuardedServer::answer(const Refusal& refusal) const
{
    const std::string body = problem_body_(refusal.status, refusal.fault, refusal.detail);
    std::string text = "HTTP/1.1 " + std::to_string(refusal.status) + ' ';
    text.append(reason(refusal.status));
    text += "\r\nContent-Type: application/problem+json\r\nConnection: close\r\n";
    if (refusal.status == 503) { text += "Retry-After: 1\r\n"; }
    return text + "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
}

}  // namespace relight
