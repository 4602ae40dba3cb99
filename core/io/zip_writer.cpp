#include "core/io/zip_writer.h"

#include <zlib.h>

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <utility>

namespace relight {
namespace {

constexpr std::size_t crc_in_local_header = 14;
constexpr std::uint16_t utf8_names = 1U << 11U;
constexpr std::uint16_t oldest_date = (1U << 5U) | 1U;  // 1980-01-01, as MS-DOS writes it

/// The low `bytes` bytes of a number, little end first.
void append(std::string& out, std::uint64_t value, int bytes)
{
    for (; bytes > 0; --bytes, value >>= 8U) { out += static_cast<char>(value & 0xffU); }
}

std::uint32_t crc_of(std::string_view bytes)
{
    uLong crc = crc32_z(0, nullptr, 0);
    crc = crc32_z(crc, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    return static_cast<std::uint32_t>(crc);
}

}  // namespace

ZipWriter::ZipWriter(std::uint64_t expected_size, std::uint64_t zip64_from)
    : zip64_(expected_size >= zip64_from)
{
    out_.reserve(expected_size);
}

/// What local and central headers share, from "version needed" to the lengths of name and extra
/// field.
void ZipWriter::append_sizes(const Entry& entry)
{
    append(out_, zip64_ ? 45 : 20, 2);
    append(out_, utf8_names, 2);
    append(out_, 0, 2);  // stored
    append(out_, 0, 2);  // midnight
    append(out_, oldest_date, 2);
    append(out_, entry.crc, 4);
    append(out_, zip64_ ? 0xffff'ffffU : entry.size, 4);
    append(out_, zip64_ ? 0xffff'ffffU : entry.size, 4);
    append(out_, entry.name.size(), 2);
}

void ZipWriter::open(std::string_view name, std::uint64_t size)
{
    const Entry entry{std::string(name.substr(0, 0xffff)), size, out_.size(), 0};
    append(out_, 0x0403'4b50, 4);
    append_sizes(entry);
    append(out_, zip64_ ? 20 : 0, 2);
    out_ += entry.name;
    if (zip64_) {
        append(out_, 1, 2);
        append(out_, 16, 2);
        append(out_, size, 8);
        append(out_, size, 8);
    }
    entries_.push_back(entry);
    data_ = out_.size();
}

void ZipWriter::close()
{
    Entry& entry = entries_.back();
    assert(out_.size() - data_ == entry.size);
    entry.crc = crc_of(std::string_view(out_).substr(data_));
    std::string crc;
    append(crc, entry.crc, 4);
    out_.replace(entry.offset + crc_in_local_header, 4, crc);
}

std::string ZipWriter::finish() &&
{
    const std::uint64_t directory = out_.size();
    for (const Entry& entry : entries_) {
        append(out_, 0x0201'4b50, 4);
        append(out_, 45, 2);  // made by
        append_sizes(entry);
        append(out_, zip64_ ? 28 : 0, 2);
        append(out_, 0, 2 + 2 + 2 + 4);  // no comment, disk 0, no attributes
        append(out_, zip64_ ? 0xffff'ffffU : entry.offset, 4);
        out_ += entry.name;
        if (zip64_) {
            append(out_, 1, 2);
            append(out_, 24, 2);
            append(out_, entry.size, 8);
            append(out_, entry.size, 8);
            append(out_, entry.offset, 8);
        }
    }
    const std::uint64_t end = out_.size();
    if (zip64_) {
        append(out_, 0x0606'4b50, 4);
        append(out_, 44, 8);  // bytes that follow in this record
        append(out_, 45, 2);
        append(out_, 45, 2);
        append(out_, 0, 4 + 4);  // disks
        append(out_, entries_.size(), 8);
        append(out_, entries_.size(), 8);
        append(out_, end - directory, 8);
        append(out_, directory, 8);
        append(out_, 0x0706'4b50, 4);  // and where it is
        append(out_, 0, 4);
        append(out_, end, 8);
        append(out_, 1, 4);
    }
    append(out_, 0x0605'4b50, 4);
    append(out_, 0, 2 + 2);  // disks
    append(out_, entries_.size(), 2);
    append(out_, entries_.size(), 2);
    append(out_, zip64_ ? 0xffff'ffffU : end - directory, 4);
    append(out_, zip64_ ? 0xffff'ffffU : directory, 4);
    append(out_, 0, 2);  // no comment
    return std::move(out_);
}

}  // namespace relight
