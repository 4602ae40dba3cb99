#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace relight {

/// An open file; closed with it. What fails throws std::system_error.
class File {
  public:
    File() = default;
    File(const std::filesystem::path& path, int flags);
    File(File&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
    File& operator=(File&& other) noexcept
    {
        std::swap(fd_, other.fd_);
        return *this;
    }
    ~File();

    explicit operator bool() const { return fd_ >= 0; }
    int descriptor() const { return fd_; }
    std::uint64_t size() const;
    void write(std::string_view bytes);
    void sync();  ///< what was written survives a crash
    /// Bytes read at `offset`; fewer than asked for at the file's end.
    std::size_t read_at(std::uint64_t offset, std::span<std::byte> into) const;
    std::vector<std::byte> read_all() const;

  private:
    int fd_ = -1;
};

}  // namespace relight
