#include "server/guarded_stream.h"

#include <poll.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdlib>

#include "server/head_scanner.h"

namespace relight {
namespace {

constexpr std::size_t head_piece = std::size_t{4} << 10;  // per recv(): idle clients hold little
constexpr std::size_t linger_piece = std::size_t{64} << 10;
constexpr std::chrono::seconds linger_time{2};

}  // namespace

Address numeric_address(const sockaddr_storage& address, socklen_t size)
{
    std::array<char, NI_MAXHOST> host{};
    std::array<char, NI_MAXSERV> service{};
    if (getnameinfo(reinterpret_cast<const sockaddr*>(&address), size, host.data(), host.size(),
                    service.data(), service.size(), NI_NUMERICHOST | NI_NUMERICSERV) != 0) {
        return {};
    }
    return {host.data(), static_cast<int>(std::strtol(service.data(), nullptr, 10))};
}

GuardedStream::GuardedStream(int fd, const GuardLimits& limits, const std::atomic<bool>& stopping)
    : fd_(fd),
      limits_(limits),
      stopping_(stopping),
      reading_(limits.grace, limits.transfer_time, limits.least_rate),
      writing_(reading_)
{
}

void GuardedStream::consume(std::size_t bytes)
{
    input_at_ += bytes;
    if (input_at_ == input_.size()) {
        input_.clear();
        input_at_ = 0;
    }
}

/// Takes what has arrived, up to `most` bytes, waiting only if there is nothing.
GuardedStream::Fill GuardedStream::fill(Patience& patience, std::size_t most)
{
    input_.erase(0, input_at_);
    input_at_ = 0;
    const std::size_t before = input_.size();
    for (;;) {
        input_.resize(before + most);
        const ssize_t n = recv(fd_, input_.data() + before, most, MSG_DONTWAIT);
        const int error = errno;
        input_.resize(before + (n > 0 ? static_cast<std::size_t>(n) : 0));
        if (n > 0) {
            patience.earn(static_cast<std::size_t>(n));
            return Fill::Some;
        }
        if (n == 0 || (error != EAGAIN && error != EWOULDBLOCK && error != EINTR)) {
            return Fill::End;
        }
        if (!patience.wait(fd_, POLLIN)) { return Fill::TimedOut; }
    }
}

bool GuardedStream::wait_for_input(std::chrono::milliseconds time)
{
    if (!buffered().empty()) { return true; }
    input_.shrink_to_fit();  // a waiting connection keeps no buffer
    return Patience(time, time, 0.0).wait(fd_, POLLIN);
}

std::optional<Refusal> GuardedStream::read_head()
{
    HeadScanner scanner(limits_.head);
    Patience patience(limits_.head_time, limits_.head_time, 0.0);
    for (;;) {
        const auto found = scanner.scan(buffered());
        if (const auto* refused = std::get_if<Refusal>(&found)) { return *refused; }
        if (const auto* text = std::get_if<std::string_view>(&found)) {
            auto parsed = parse_head(*text, limits_.head);
            if (auto* refused = std::get_if<Refusal>(&parsed)) { return *refused; }
            head_ = std::get<RequestHead>(std::move(parsed));
            break;
        }
        switch (fill(patience, head_piece)) {
            case Fill::Some:
                break;
            case Fill::End:
                return Refusal{};
            case Fill::TimedOut:
                return Refusal{408, Fault::RequestTimeout,
                               "the request's head took longer than " +
                                   std::to_string(limits_.head_time.count()) + " ms"};
        }
    }
    consume(scanner.size());
    head_at_ = 0;
    left_ = total_ = head_.content_length;
    framing_bytes_ = 0;
    in_chunk_ = false;
    body_done_ = head_.framing == Framing::None ||
                 (head_.framing == Framing::Length && head_.content_length == 0);
    continue_due_ = head_.expects_continue && !body_done_;
    answered_ = false;
    refusal_.reset();
    reading_ = writing_ = Patience(limits_.grace, limits_.transfer_time, limits_.least_rate);
    if (total_ > limits_.body_bytes) {
        refuse_too_large();
        return refusal_;
    }
    return {};
}

ssize_t GuardedStream::read(char* into, std::size_t size)
{
    const std::string& head = head_.normalised;
    if (head_at_ == head.size()) { return read_body(into, size); }
    const std::size_t n = head.copy(into, size, head_at_);
    head_at_ += n;
    return static_cast<ssize_t>(n);
}

bool GuardedStream::send_all(std::string_view bytes)
{
    while (!bytes.empty() && !broken_) {
        const ssize_t n = send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
        if (n >= 0) {
            writing_.earn(static_cast<std::size_t>(n));
            bytes.remove_prefix(static_cast<std::size_t>(n));
        } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
            broken_ = !writing_.wait(fd_, POLLOUT);
        } else if (errno != EINTR) {
            broken_ = true;
        }
    }
    return !broken_;
}

ssize_t GuardedStream::write(const char* bytes, std::size_t size)
{
    // Once the body is refused, the handler's answer rests on half a body: the guard answers.
    if (refusal_ && !answered_) { return -1; }
    std::string_view text(bytes, size);
    std::string closing;
    if (!answered_ && (body_pending() || stopping_)) {
        // The library hands over a whole head at once and does not know that this is the last.
        constexpr std::string_view keep = "\r\nKeep-Alive: ";
        const auto at = text.find(keep);
        if (at != std::string_view::npos) {
            closing = text;
            closing.replace(at, text.find("\r\n", at + keep.size()) - at, "\r\nConnection: close");
            text = closing;
        }
    }
    answered_ = true;
    return send_all(text) ? static_cast<ssize_t>(size) : -1;
}

void GuardedStream::linger()
{
    shutdown(fd_, SHUT_WR);
    const auto end = std::chrono::steady_clock::now() + linger_time;  // a flood costs no patience
    Patience patience(linger_time, linger_time, 0.0);
    do {
        consume(buffered().size());
    } while (fill(patience, linger_piece) == Fill::Some && std::chrono::steady_clock::now() < end);
}

bool GuardedStream::is_writable() const
{
    pollfd watched{fd_, POLLOUT, 0};
    return !broken_ && poll(&watched, 1, 0) > 0 && (watched.revents & (POLLHUP | POLLERR)) == 0;
}

void GuardedStream::get_remote_ip_and_port(std::string& ip, int& port) const
{
    sockaddr_storage address{};
    socklen_t size = sizeof address;
    if (getpeername(fd_, reinterpret_cast<sockaddr*>(&address), &size) != 0) { return; }
    const Address peer = numeric_address(address, size);
    ip = peer.ip;
    port = peer.port;
}

void GuardedStream::get_local_ip_and_port(std::string& ip, int& port) const
{
    sockaddr_storage address{};
    socklen_t size = sizeof address;
    if (getsockname(fd_, reinterpret_cast<sockaddr*>(&address), &size) != 0) { return; }
    const Address own = numeric_address(address, size);
    ip = own.ip;
    port = own.port;
}

}  // namespace relight
