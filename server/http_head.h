#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include "core/base/fault.h"

namespace relight {

/// The most a request's head may hold; beyond it the request is refused with 414 or 431.
struct HeadLimits {
    std::size_t bytes = std::size_t{32} << 10;      ///< the whole head
    std::size_t line_bytes = std::size_t{8} << 10;  ///< one line
    std::size_t lines = 100;                        ///< request line and fields together
    std::size_t target_bytes = 2048;                ///< the request target: path and query
    /// The path alone. Routes are matched by std::regex, which recurses: some 320 bytes of stack,
    /// kept as long as the connection, for each byte of the path.
    std::size_t path_bytes = 256;
};

/// An answer the guard gives itself, after which the connection closes.
struct Refusal {
    int status = 0;  ///< HTTP status; 0: the client is gone, there is nobody to tell
    Fault fault = Fault::BadRequest;
    std::string detail;  ///< what was found and what is allowed; never the client's own text
};

/// How long the body is, decided once and for all from the head (RFC 9112, 6.3).
enum class Framing { None, Length, Chunked };

/// A head that can be read in one way only.
struct RequestHead {
    std::string normalised;  ///< what the library is given: "METHOD target version", fields, CRLF
    Framing framing = Framing::None;
    std::uint64_t content_length = 0;  ///< bytes; only with Framing::Length
    bool keep_alive = true;            ///< the client wants the connection kept
    bool expects_continue = false;     ///< it waits for "100 Continue" before it sends the body
};

/// The client's Accept-Encoding under a name that no client can send: the library, which would
/// compress at its own discretion, never sees the original.
inline constexpr const char* accept_encoding_field = "Relight-Accept-Encoding";

/// Reads a head that `HeadScanner` has passed, strictly by RFC 9110 and 9112: whatever two parsers
/// could read differently is refused. Fields the library would misread or act upon (Range,
/// Accept-Encoding, Transfer-Encoding, Connection, Expect …) are decided here and left out of
/// `normalised`. A multipart type is handed on as "Multipart/…" so that the library, which looks
/// for the lower-case word, leaves the parts to us.
std::variant<RequestHead, Refusal> parse_head(std::string_view head, const HeadLimits& limits);

/// Whether `line` is a well-formed "name: value" field; for trailers, which are then ignored.
bool is_field_line(std::string_view line);

}  // namespace relight
