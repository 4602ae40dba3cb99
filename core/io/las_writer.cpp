#include <cassert>
#include <cstring>
#include <string>

#include "core/io/las_header.h"
#include "core/io/pieces.h"
#include "core/io/writers.h"

namespace relight {
namespace {

/// The point format that has all that `format` has, and R G B. Test: LasWriter.*
unsigned colored(unsigned format)
{
    constexpr std::array<unsigned, las_formats.size()> with_rgb = {2, 3, 2, 3,  5, 5,
                                                                   7, 7, 8, 10, 10};
    return with_rgb[format];
}

template <class T>
void put(std::string& file, std::size_t at, T value)
{
    std::memcpy(file.data() + at, &value, sizeof(T));
}

/// Moves the place that is written at `at`, if what is there lies behind the points.
void shift(std::string& file, std::size_t at, std::size_t end, std::size_t by)
{
    const auto place =
        las_value<std::uint64_t>(reinterpret_cast<const std::byte*>(file.data()) + at);
    if (place >= end) { put<std::uint64_t>(file, at, place + by); }
}

}  // namespace

Result<Encoding> encode_las(std::span<const std::byte> file, std::span<const Rgb8> color)
{
    const Result<LasHeader> header = read_las_header(file);
    if (!header) { return header.error(); }
    assert(color.size() == header->count);
    const unsigned format = colored(header->format);
    const std::size_t rgb = las_formats[format].rgb;
    const std::size_t grown = las_formats[format].size - las_formats[header->format].size;
    if (header->length + grown > 0xFFFF) {
        return Error{Fault::MalformedHeader,
                     "records of " + std::to_string(header->length) +
                         " bytes leave no room for R G B; the format allows 65535",
                     {},
                     {},
                     las::record_length};
    }
    std::string head(reinterpret_cast<const char*>(file.data()), header->points);
    // Formats with R G B came with version 1.2, whose header is laid out as those before.
    if (header->minor < 2) { head[las::minor_version] = 2; }
    put(head, las::point_format, static_cast<unsigned char>(format));
    put(head, las::record_length, static_cast<std::uint16_t>(header->length + grown));
    if (header->minor >= 3) { shift(head, las::waveforms, header->end(), header->count * grown); }
    if (header->minor >= 4) {
        shift(head, las::extended_records, header->end(), header->count * grown);
    }
    const auto write_points = [file, color, rgb, grown, points = header->points,
                               length = header->length](BlockOut& out) {
        const std::byte* record = file.data() + points;
        for (std::size_t i = 0; i < color.size() && out.open(); ++i, record += length) {
            char* const to = out.room(length + grown);
            std::memcpy(to, record, rgb);
            // R G B, and a near infrared of 0 where the format has one
            std::memset(to + rgb, 0, grown);
            std::memcpy(to + rgb + grown, record + rgb, length - rgb);
            for (std::size_t band = 0; band < 3; ++band) {
                const auto code = static_cast<std::uint16_t>(color[i][band] * 257);
                std::memcpy(to + rgb + 2 * band, &code, sizeof(code));
            }
        }
    };
    return joined({text_piece(std::move(head)),
                   {std::uint64_t{header->count} * (header->length + grown), write_points},
                   span_piece(file.subspan(header->end()))});
}

}  // namespace relight
