#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "server/request.h"

namespace relight {

/// "model/ply", "application/json" …: what an answer of this format is sent as.
std::string_view media_type(Format format);

/// The format an Accept header (RFC 9110, 12.5.1) asks for: that of greatest q, PLY among equals
/// and where the header is empty; nothing if it accepts none of ours.
std::optional<Format> format_accepted(std::string_view accept);

/// Whether an Accept-Encoding header takes gzip.
bool accepts_gzip(std::string_view accept_encoding);

/// The type of a Content-Type without its parameters, lower case.
std::string essence(std::string_view content_type);

}  // namespace relight
