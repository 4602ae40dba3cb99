#pragma once

#include <string>
#include <string_view>

#include "core/io/sink.h"

namespace relight {

/// RFC 1952, fastest level, packed while it is written: nobody holds all of it.
Encoding gzipped(Encoding plain);

std::string gzip(std::string_view bytes);

}  // namespace relight
