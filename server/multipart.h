#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"
#include "server/sha256.h"

namespace relight {

/// One part of a multipart/form-data body.
struct Part {
    std::string name;
    std::string content_type;  ///< empty if the part names none
    std::string data;
    std::string id{};  ///< SHA-256 of the data, as of what is stored; not of "request"
};

struct MultipartLimits {
    std::size_t parts = 16;
    std::size_t head_bytes = 4096;  ///< of one part's header lines
    std::size_t name_bytes = 128;
    std::uint64_t request_bytes = 16U << 20U;  ///< of the part "request"
};

/// The boundary of a Content-Type multipart/form-data (RFC 2046: 1 to 70 characters of a safe set);
/// nothing if the type is another or the boundary is no boundary.
std::optional<std::string> multipart_boundary(std::string_view content_type);

/// Reads multipart/form-data (RFC 7578) as it arrives, strictly: no preamble, CRLF line ends,
/// unique names, the closing delimiter. The caller bounds the whole body.
class MultipartParser {
  public:
    MultipartParser(const std::string& boundary, const MultipartLimits& limits);

    /// Takes the next piece; false once the body is wrong: finish() says why.
    bool feed(std::string_view piece);

    /// The parts in their order. Errors: BadRequest, BodyTooLarge.
    Result<std::vector<Part>> finish() &&;

  private:
    enum class State { AfterDelimiter, Head, Data, End };

    bool fail(Fault fault, std::string detail);
    bool step(bool& progressed);
    bool read_after_delimiter(bool& progressed);
    bool read_head(bool& progressed);
    bool read_data(bool& progressed);
    bool add_part(std::string_view head);

    std::string delimiter_;  // CRLF -- boundary
    MultipartLimits limits_;
    std::string buffer_;  // received, not yet understood
    State state_ = State::Data;
    bool before_first_ = true;
    std::vector<Part> parts_;
    Sha256 hash_;  // of the last part, as it comes
    std::optional<Error> error_;
};

}  // namespace relight
