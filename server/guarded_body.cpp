// GuardedStream's reading of bodies: counted, timed, and chunks decoded.
#include <algorithm>
#include <charconv>

#include "server/guarded_stream.h"

namespace relight {
namespace {

constexpr std::size_t body_piece = std::size_t{64} << 10;  // per recv(): few system calls
constexpr std::size_t chunk_line_bytes = 512;              // a size in hex and its extensions
constexpr std::size_t framing_bytes = 8192;  // all extensions and trailers of one body

}  // namespace

bool GuardedStream::refuse(int status, Fault fault, std::string detail)
{
    refusal_ = Refusal{status, fault, std::move(detail)};
    return false;
}

bool GuardedStream::refuse_too_large()
{
    return refuse(
        413, Fault::BodyTooLarge,
        "the body has more than the " + std::to_string(limits_.body_bytes) + " bytes allowed");
}

/// Makes `buffered()` longer, or refuses the request.
bool GuardedStream::need_input()
{
    if (continue_due_ && buffered().empty()) {
        continue_due_ = false;
        if (!send_all("HTTP/1.1 100 Continue\r\n\r\n")) { return refuse(0, Fault::BadRequest, ""); }
    }
    switch (fill(reading_, body_piece)) {
        case Fill::Some:
            return true;
        case Fill::End:
            return refuse(400, Fault::BadRequest, "the body ends before its framing says");
        case Fill::TimedOut:
            break;
    }
    return refuse(408, Fault::RequestTimeout,
                  "the body came too slowly: at least " +
                      std::to_string(static_cast<long>(limits_.least_rate)) +
                      " bytes/s are expected, with pauses of " +
                      std::to_string(limits_.grace.count()) + " ms, within " +
                      std::to_string(limits_.transfer_time.count()) + " ms");
}

/// Bytes of the body, 0 at its end, -1 when it is refused.
ssize_t GuardedStream::read_body(char* into, std::size_t size)
{
    if (refusal_) { return -1; }
    if (body_done_ || size == 0) { return 0; }
    continue_due_ = continue_due_ && buffered().empty();  // it has not waited
    if (head_.framing == Framing::Chunked && left_ == 0 && !next_chunk()) { return -1; }
    if (body_done_) { return 0; }
    if (buffered().empty() && !need_input()) { return -1; }
    const auto most = static_cast<std::size_t>(std::min<std::uint64_t>(left_, size));
    const std::size_t n = buffered().copy(into, most);
    consume(n);
    left_ -= n;
    body_done_ = left_ == 0 && head_.framing == Framing::Length;
    return static_cast<ssize_t>(n);
}

/// One line without its CR LF; refuses others' ends and lines of more than `most` bytes.
bool GuardedStream::read_line(std::string& line, std::size_t most)
{
    line.clear();
    for (;;) {
        if (buffered().empty() && !need_input()) { return false; }
        const char c = buffered().front();
        consume(1);
        const bool after_cr = !line.empty() && line.back() == '\r';
        if (after_cr != (c == '\n')) {
            return refuse_chunk("a line between the chunks does not end in CR LF");
        }
        if (c == '\n') {
            line.pop_back();
            return true;
        }
        if ((static_cast<unsigned char>(c) < 0x20 && c != '\r' && c != '\t') || c == 0x7f) {
            return refuse_chunk("a line between the chunks holds a control character");
        }
        line += c;
        if (line.size() > most + 1) {
            return refuse_chunk("a chunk's extensions or the trailers are too long");
        }
    }
}

/// The size line of the next chunk (RFC 9112, 7.1); after the last one the trailers too.
bool GuardedStream::next_chunk()
{
    std::string line;
    if (in_chunk_) {
        if (!read_line(line, 0)) { return false; }
        in_chunk_ = false;
    }
    if (!read_line(line, chunk_line_bytes)) { return false; }
    const auto digits = std::min(line.find_first_not_of("0123456789abcdefABCDEF"), line.size());
    if (digits == 0 || digits > 16 || (digits < line.size() && line[digits] != ';')) {
        return refuse_chunk("a chunk's size is not a hexadecimal number");
    }
    framing_bytes_ += line.size() - digits;
    if (framing_bytes_ > framing_bytes) {
        return refuse_chunk("the chunks' extensions are too long");
    }
    std::from_chars(line.data(), line.data() + digits, left_, 16);  // 16 digits always fit
    if (left_ > limits_.body_bytes - total_) { return refuse_too_large(); }
    total_ += left_;
    in_chunk_ = left_ > 0;
    return in_chunk_ || read_trailers();
}

/// Trailers are checked and ignored, as RFC 9110, 6.5.1 lets us.
bool GuardedStream::read_trailers()
{
    for (std::string line;;) {
        if (!read_line(line, framing_bytes - framing_bytes_)) { return false; }
        if (line.empty()) { break; }
        if (!is_field_line(line)) { return refuse_chunk("a trailer is not \"Name: value\""); }
        framing_bytes_ = std::min(framing_bytes, framing_bytes_ + line.size());
    }
    body_done_ = true;
    return true;
}

}  // namespace relight
