#pragma once

#include <httplib.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "server/guard_limits.h"
#include "server/http_head.h"
#include "server/patience.h"

namespace relight {

/// A socket address in numbers: "127.0.0.1" and its port.
struct Address {
    std::string ip;
    int port = -1;
};
Address numeric_address(const sockaddr_storage& address, socklen_t size);

/// One connection as the library may see it: a head that can be read in one way only, then exactly
/// the bytes of its body (chunks already decoded), then end of file; writes that wait for no slow
/// reader for ever. Bytes beyond the request stay here for the next one.
class GuardedStream : public httplib::Stream {
  public:
    /// @param fd a connected socket, non-blocking; still the caller's to close
    /// @param stopping once true, the answer announces that the connection closes
    GuardedStream(int fd, const GuardLimits& limits, const std::atomic<bool>& stopping);

    // What the guard calls, in this order.

    /// Waits up to `time` for the first byte of a request; false: none came.
    bool wait_for_input(std::chrono::milliseconds time);
    /// Reads and judges the next head; what follows is this request's. A refusal ends it all.
    std::optional<Refusal> read_head();
    const RequestHead& head() const { return head_; }
    /// Why the body could not be read, if so; then the library's answer has been held back.
    const std::optional<Refusal>& refusal() const { return refusal_; }
    bool answered() const { return answered_; }        ///< some of an answer has been written
    bool body_pending() const { return !body_done_; }  ///< the next bytes are not a request
    /// Sends `bytes` as they are; false: the client is gone or too slow.
    bool send_all(std::string_view bytes);
    /// Ends our side and discards what the client still sends for a moment: closing with unread
    /// input would reset the connection and could destroy the answer before it is read.
    void linger();

    // What the library calls.

    bool is_readable() const override { return !broken_; }
    bool is_writable() const override;
    ssize_t read(char* into, std::size_t size) override;
    ssize_t write(const char* bytes, std::size_t size) override;
    void get_remote_ip_and_port(std::string& ip, int& port) const override;
    void get_local_ip_and_port(std::string& ip, int& port) const override;
    socket_t socket() const override
    {
        return 0;
    }  ///< the library select()s: 1024 would be too big

  private:
    enum class Fill { Some, End, TimedOut };
    Fill fill(Patience& patience, std::size_t most);
    std::string_view buffered() const { return std::string_view(input_).substr(input_at_); }
    void consume(std::size_t bytes);

    ssize_t read_body(char* into, std::size_t size);
    bool refuse(int status, Fault fault, std::string detail);
    bool refuse_chunk(const char* detail) { return refuse(400, Fault::BadRequest, detail); }
    bool refuse_too_large();
    bool need_input();
    bool read_line(std::string& line, std::size_t most);
    bool next_chunk();
    bool read_trailers();

    int fd_;
    const GuardLimits& limits_;
    const std::atomic<bool>& stopping_;
    std::string input_;  // received, not yet consumed, from input_at_
    std::size_t input_at_ = 0;
    RequestHead head_;
    std::size_t head_at_ = 0;        // of head_.normalised, handed to the library so far
    std::uint64_t left_ = 0;         // bytes of the body or of this chunk still to come
    std::uint64_t total_ = 0;        // body bytes announced so far
    std::size_t framing_bytes_ = 0;  // chunk extensions and trailers so far
    bool in_chunk_ = false;          // its CRLF is still to come
    bool body_done_ = true;
    bool continue_due_ = false;
    bool answered_ = false;
    bool broken_ = false;  // nothing more can be written
    std::optional<Refusal> refusal_;
    Patience reading_, writing_;
};

}  // namespace relight
