#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace relight {

/// A .zip of stored (uncompressed) files, built in one string. All files bear the oldest time a
/// .zip knows, so that the same content gives the same bytes. (PKWARE APPNOTE 6.3, sections 4.3
/// and 4.5.)
class ZipWriter {
  public:
    /// From `zip64_from` bytes on the archive uses 64-bit sizes, which old readers may not know.
    explicit ZipWriter(std::uint64_t expected_size, std::uint64_t zip64_from = 0xffff'0000U);

    /// Starts a file of exactly `size` bytes, which the caller then appends to bytes().
    void open(std::string_view name, std::uint64_t size);
    std::string& bytes() { return out_; }
    void close();

    /// The whole archive.
    std::string finish() &&;

  private:
    struct Entry {
        std::string name;
        std::uint64_t size{}, offset{};
        std::uint32_t crc{};
    };
    void append_sizes(const Entry& entry);

    std::string out_;
    std::vector<Entry> entries_;
    std::size_t data_ = 0;  // where the open file's bytes start
    bool zip64_;
};

}  // namespace relight
