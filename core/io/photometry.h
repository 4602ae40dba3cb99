#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "core/base/camera.h"
#include "core/base/progress.h"
#include "core/base/result.h"
#include "core/light/ies.h"

namespace relight {

/// Radiance RGBE (.hdr, .pic): linear RGB, row 0 on top. Strict (fuzzed): flat, old and new run
/// lengths; -Y M +X N as filed by everyone; resolution checked against the bytes that remain before
/// anything is allocated. EXPOSURE lines are divided out. Errors: EmptyFile, MalformedHeader,
/// MalformedBody, Truncated, CountExceedsFile, OutOfRange (too many pixels, exposures),
/// NotAvailable (XYZE, turned or mirrored), Cancelled. The image has no coverage.
Result<Image> read_hdr(std::span<const std::byte> file, std::uint64_t most_pixels,
                       Progress& progress);

/// IESNA LM-63 (1986, 1991, 1995, 2002), photometric type C; strict (fuzzed). Candela come out with
/// the multiplier and the ballast factor multiplied in. TILT=NONE and TILT=INCLUDE (its factors are
/// not applied: upright lamps). Errors: as above, NotAvailable for types A and B and TILT=<file>.
Result<IesProfile> read_ies(std::span<const std::byte> file, Progress& progress);

}  // namespace relight
