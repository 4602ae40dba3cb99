#include "core/io/zip_writer.h"

#include <zlib.h>

#include <algorithm>
#include <cstddef>
#include <utility>

namespace relight {
namespace {

constexpr std::uint16_t utf8_names = 1U << 11U;
constexpr std::uint16_t oldest_date = (1U << 5U) | 1U;  // 1980-01-01, as MS-DOS writes it
constexpr std::uint64_t elsewhere = 0xffff'ffffU;       // a size that a 64-bit field says

struct Archive {
    std::vector<ZipFile> files;
    bool zip64 = false;
};

/// The low `bytes` bytes of a number, little end first.
void append(std::string& out, std::uint64_t value, int bytes)
{
    for (; bytes > 0; --bytes, value >>= 8U) { out += static_cast<char>(value & 0xffU); }
}

std::uint32_t crc_of(const Piece& content)
{
    uLong crc = crc32_z(0, nullptr, 0);
    const Sink take = [&](std::string_view bytes) {
        crc = crc32_z(crc, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
        return true;
    };
    BlockOut out(take);
    content.write(out);
    out.flush();
    return static_cast<std::uint32_t>(crc);
}

/// What local and central headers share, from "version needed" to the length of the name.
void append_sizes(std::string& out, const ZipFile& file, std::uint32_t crc, bool zip64)
{
    append(out, zip64 ? 45 : 20, 2);
    append(out, utf8_names, 2);
    append(out, 0, 2);  // stored
    append(out, 0, 2);  // midnight
    append(out, oldest_date, 2);
    append(out, crc, 4);
    append(out, zip64 ? elsewhere : file.content.bytes, 4);
    append(out, zip64 ? elsewhere : file.content.bytes, 4);
    append(out, file.name.size(), 2);
}

std::string local_header(const ZipFile& file, std::uint32_t crc, bool zip64)
{
    std::string out;
    append(out, 0x0403'4b50, 4);
    append_sizes(out, file, crc, zip64);
    append(out, zip64 ? 20 : 0, 2);
    out += file.name;
    if (zip64) {
        append(out, 1, 2);
        append(out, 16, 2);
        append(out, file.content.bytes, 8);
        append(out, file.content.bytes, 8);
    }
    return out;
}

void append_central_header(std::string& out, const ZipFile& file, std::uint32_t crc,
                           std::uint64_t offset, bool zip64)
{
    append(out, 0x0201'4b50, 4);
    append(out, 45, 2);  // made by
    append_sizes(out, file, crc, zip64);
    append(out, zip64 ? 28 : 0, 2);
    append(out, 0, 2 + 2 + 2 + 4);  // no comment, disk 0, no attributes
    append(out, zip64 ? elsewhere : offset, 4);
    out += file.name;
    if (zip64) {
        append(out, 1, 2);
        append(out, 24, 2);
        append(out, file.content.bytes, 8);
        append(out, file.content.bytes, 8);
        append(out, offset, 8);
    }
}

/// The archive's end: the central directory, and where it is.
std::string directory_of(const Archive& archive, const std::vector<std::uint32_t>& crcs)
{
    std::string out;
    std::uint64_t begin = 0;
    for (std::size_t i = 0; i < archive.files.size(); ++i) {
        const ZipFile& file = archive.files[i];
        append_central_header(out, file, crcs[i], begin, archive.zip64);
        begin += local_header(file, 0, archive.zip64).size() + file.content.bytes;
    }
    const std::uint64_t size = out.size(), count = archive.files.size();
    if (archive.zip64) {
        append(out, 0x0606'4b50, 4);
        append(out, 44, 8);  // bytes that follow in this record
        append(out, 45, 2);
        append(out, 45, 2);
        append(out, 0, 4 + 4);  // disks
        append(out, count, 8);
        append(out, count, 8);
        append(out, size, 8);
        append(out, begin, 8);
        append(out, 0x0706'4b50, 4);  // and where it is
        append(out, 0, 4);
        append(out, begin + size, 8);
        append(out, 1, 4);
    }
    append(out, 0x0605'4b50, 4);
    append(out, 0, 2 + 2);  // disks
    append(out, count, 2);
    append(out, count, 2);
    append(out, archive.zip64 ? elsewhere : size, 4);
    append(out, archive.zip64 ? elsewhere : begin, 4);
    append(out, 0, 2);  // no comment
    return out;
}

std::uint64_t size_of(const Archive& archive)
{
    std::uint64_t size =
        directory_of(archive, std::vector<std::uint32_t>(archive.files.size())).size();
    for (const ZipFile& file : archive.files) {
        size += local_header(file, 0, archive.zip64).size() + file.content.bytes;
    }
    return size;
}

bool write(const Archive& archive, const Sink& sink)
{
    BlockOut out(sink);
    std::vector<std::uint32_t> crcs;
    for (const ZipFile& file : archive.files) {
        crcs.push_back(crc_of(file.content));
        out.bytes(local_header(file, crcs.back(), archive.zip64));
        file.content.write(out);
        if (!out.open()) { return false; }
    }
    out.bytes(directory_of(archive, crcs));
    return out.flush();
}

}  // namespace

Encoding encode_zip(std::vector<ZipFile> files, std::uint64_t zip64_from)
{
    Archive archive{std::move(files), false};
    for (ZipFile& file : archive.files) {
        file.name.resize(std::min<std::size_t>(file.name.size(), 0xffff));
    }
    archive.zip64 = size_of(archive) >= zip64_from;
    const std::uint64_t bytes = size_of(archive);
    return {bytes,
            [archive = std::move(archive)](const Sink& sink) { return write(archive, sink); }};
}

}  // namespace relight
