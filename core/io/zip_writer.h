#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/io/pieces.h"

namespace relight {

struct ZipFile {
    std::string name;
    Piece content;
};

/// A .zip of stored (uncompressed) files. All bear the oldest time a .zip knows, so that the same
/// content gives the same bytes. Each file is gone through twice: its checksum comes before it, for
/// that is what every reader takes. (PKWARE APPNOTE 6.3, sections 4.3 and 4.5.) From `zip64_from`
/// bytes on the archive uses 64-bit sizes, which old readers may not know.
Encoding encode_zip(std::vector<ZipFile> files, std::uint64_t zip64_from = 0xffff'0000U);

}  // namespace relight
