#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "core/base/result.h"

namespace relight {

/// A number as it lies in the file, which is little-endian as we are.
template <class T>
T las_value(const std::byte* at)
{
    static_assert(std::endian::native == std::endian::little);
    T value;
    std::memcpy(&value, at, sizeof(T));
    return value;
}

/// Standard part of a point record [byte] and where its R G B lie (0: it has none), by format.
struct LasFormat {
    std::size_t size, rgb;
};
inline constexpr std::array<LasFormat, 11> las_formats = {{{20, 0},
                                                           {28, 0},
                                                           {26, 20},
                                                           {34, 28},
                                                           {57, 0},
                                                           {63, 28},
                                                           {30, 0},
                                                           {36, 30},
                                                           {38, 30},
                                                           {59, 0},
                                                           {67, 30}}};

/// Places in a header [byte].
namespace las {
inline constexpr std::size_t minor_version = 25, point_format = 104, record_length = 105;
inline constexpr std::size_t waveforms = 227, extended_records = 235;  // from 1.3, from 1.4
}  // namespace las

/// What the public header block of a LAS file says of its points.
struct LasHeader {
    unsigned minor = 0;      ///< version 1.minor
    unsigned format = 0;     ///< 0..10
    std::size_t points = 0;  ///< where they start [byte]
    std::size_t length = 0;  ///< of a record [byte]
    std::size_t count = 0;   ///< 1 or more, and the file holds them
    std::array<double, 3> scale{}, offset{};

    std::size_t end() const { return points + count * length; }  ///< of the last record [byte]
};

/// Reads and checks the header (ASPRS LAS 1.4 R15, sections 2.4 to 2.6), and that the variable
/// length records before the points stay before them. Errors: EmptyFile, MalformedHeader,
/// Truncated, CountExceedsFile, NoGeometry, NonFiniteCoordinate; NotAvailable for LAZ.
Result<LasHeader> read_las_header(std::span<const std::byte> file);

}  // namespace relight
