#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/camera.h"
#include "core/base/result.h"

namespace relight {

/// A picture, finite and not negative.
struct DecodedImage {
    Image image;                ///< without coverage
    std::uint64_t negatives{};  ///< values below 0 that became 0
};

/// Makes OpenEXR work on the calling thread alone, and loads what it would load later.
void prepare_exr();

/// OpenEXR: one part of scanlines or tiles (their finest level), any compression, channels R G B or
/// Y of 16 or 32-bit floats; others are passed over. The picture is the data window, wherever it
/// lies. Sandboxed only: OpenEXR meets a client's bytes here. Throws std::bad_alloc.
/// Errors: MalformedHeader, MalformedBody, Truncated, OutOfRange (more than `most_pixels`),
/// NotAvailable (deep, several parts, other channels), NotFinite.
Result<DecodedImage> decode_exr(std::span<const std::byte> file, std::uint64_t most_pixels);

}  // namespace relight
