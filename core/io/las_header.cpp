#include "core/io/las_header.h"

#include <cmath>
#include <optional>
#include <string>

namespace relight {
namespace {

using Bytes = std::span<const std::byte>;
using Failure = std::optional<Error>;

Error at_byte(std::size_t byte, std::string detail, Fault fault = Fault::MalformedHeader)
{
    return {fault, std::move(detail), {}, {}, byte};
}

/// Bytes of the header that we need of a version 1.minor.
std::size_t least_header(unsigned minor)
{
    return minor < 3 ? 227 : minor == 3 ? 235 : 375;
}

/// Each has 54 bytes of its own, with the length of what follows them.
Failure walk_records(Bytes file, std::size_t at, std::uint32_t count, std::size_t end)
{
    constexpr std::size_t own = 54, length = 18 + 2, count_byte = 100;
    const std::size_t room = end - at;
    const auto overrun = [&] {
        return at_byte(count_byte,
                       "announces " + std::to_string(count) +
                           " variable length records, more than the " + std::to_string(room) +
                           " bytes between the header and the points hold",
                       Fault::CountExceedsFile);
    };
    if (count > room / own) { return overrun(); }
    for (std::uint32_t i = 0; i < count; ++i) {
        if (own > end - at) { return overrun(); }
        const std::size_t body = las_value<std::uint16_t>(file.data() + at + length);
        if (body > end - at - own) { return overrun(); }
        at += own + body;
    }
    return {};
}

/// From 1.4 on 64 bits say it, and the old 32 too where they can.
Result<std::uint64_t> count_of(Bytes file, unsigned minor)
{
    constexpr std::size_t old_byte = 107, new_byte = 247;
    const std::uint64_t old = las_value<std::uint32_t>(file.data() + old_byte);
    const std::uint64_t wide = minor < 4 ? old : las_value<std::uint64_t>(file.data() + new_byte);
    if (old != 0 && wide != 0 && old != wide) {
        return at_byte(new_byte, "announces " + std::to_string(wide) + " points here, but " +
                                     std::to_string(old) + " in the older count at byte " +
                                     std::to_string(old_byte));
    }
    const std::uint64_t count = wide != 0 ? wide : old;
    if (count == 0) { return Error{Fault::NoGeometry, "announces 0 points", {}, {}, old_byte}; }
    return count;
}

Failure read_transform(Bytes file, LasHeader& header)
{
    constexpr std::size_t scales = 131, offsets = 155;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t scale = scales + 8 * axis, offset = offsets + 8 * axis;
        header.scale[axis] = las_value<double>(file.data() + scale);
        header.offset[axis] = las_value<double>(file.data() + offset);
        if (!std::isfinite(header.scale[axis]) || header.scale[axis] == 0.0) {
            return at_byte(
                scale,
                std::string("the scale of ") + "xyz"[axis] +
                    " must be a finite number other than 0",
                header.scale[axis] == 0.0 ? Fault::MalformedHeader : Fault::NonFiniteCoordinate);
        }
        if (!std::isfinite(header.offset[axis])) {
            return at_byte(offset,
                           std::string("the offset of ") + "xyz"[axis] + " must be a finite number",
                           Fault::NonFiniteCoordinate);
        }
    }
    return {};
}

}  // namespace

Result<LasHeader> read_las_header(Bytes file)
{
    constexpr std::size_t major = 24, header_size = 94, point_data = 96, records = 100;
    if (file.empty()) { return Error{Fault::EmptyFile, "the file has no bytes", {}, {}, {}}; }
    if (file.size() < 4 || std::memcmp(file.data(), "LASF", 4) != 0) {
        return at_byte(0, "a LAS file starts with the letters LASF; this one does not");
    }
    const auto cut_short = [&](std::size_t needed) {
        return at_byte(
            file.size(),
            "the header takes " + std::to_string(needed) + " bytes; the file ends before",
            Fault::Truncated);
    };
    if (file.size() < least_header(0)) { return cut_short(least_header(0)); }
    const auto byte = [&](std::size_t at) { return std::to_integer<unsigned>(file[at]); };
    LasHeader header;
    header.minor = byte(las::minor_version);
    if (byte(major) != 1 || header.minor > 4) {
        return at_byte(major, "version " + std::to_string(byte(major)) + "." +
                                  std::to_string(header.minor) + " is not read; 1.0 to 1.4 are");
    }
    // LASzip sets the upper bits of the format.
    header.format = byte(las::point_format);
    if ((header.format & 0xC0U) != 0) {
        return at_byte(las::point_format,
                       "LAZ is compressed; this build has no LASzip (Debian has no package); "
                       "decompress it first, e.g. with las2las or pdal translate",
                       Fault::NotAvailable);
    }
    if (header.format >= las_formats.size()) {
        return at_byte(las::point_format, "point format " + std::to_string(header.format) +
                                              " is not known; 0 to 10 are");
    }
    const std::size_t least = least_header(header.minor);
    const std::size_t size = las_value<std::uint16_t>(file.data() + header_size);
    if (size < least) {
        return at_byte(header_size, "a header of " + std::to_string(size) + " bytes; version 1." +
                                        std::to_string(header.minor) + " needs " +
                                        std::to_string(least));
    }
    if (file.size() < size) { return cut_short(size); }
    header.points = las_value<std::uint32_t>(file.data() + point_data);
    if (header.points < size || header.points > file.size()) {
        return at_byte(point_data, "the points start at byte " + std::to_string(header.points) +
                                       "; that must be after the header of " +
                                       std::to_string(size) + " bytes and within the file of " +
                                       std::to_string(file.size()));
    }
    const auto record_count = las_value<std::uint32_t>(file.data() + records);
    if (auto failure = walk_records(file, size, record_count, header.points)) {
        return std::move(*failure);
    }
    header.length = las_value<std::uint16_t>(file.data() + las::record_length);
    const std::size_t standard = las_formats[header.format].size;
    if (header.length < standard) {
        return at_byte(las::record_length,
                       "records of " + std::to_string(header.length) + " bytes; point format " +
                           std::to_string(header.format) + " takes " + std::to_string(standard));
    }
    if (auto failure = read_transform(file, header)) { return std::move(*failure); }
    const Result<std::uint64_t> count = count_of(file, header.minor);
    if (!count) { return count.error(); }
    const std::size_t left = file.size() - header.points;
    if (*count > left / header.length) {
        return at_byte(header.minor < 4 ? 107 : 247,
                       "announces " + std::to_string(*count) + " points of " +
                           std::to_string(header.length) + " bytes, more than the " +
                           std::to_string(left) + " bytes from the first on",
                       Fault::CountExceedsFile);
    }
    header.count = *count;
    return header;
}

}  // namespace relight
