#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace relight {

/// A nameless file in memory, for another process to read or write. Its length stands from the
/// start and nobody can change it: so no mapping of it, here or there, ever loses a page. What
/// fails throws std::system_error.
class SharedMemory {
  public:
    /// `size` zeros; what is never written takes no memory.
    explicit SharedMemory(std::uint64_t size);
    /// A copy of `bytes`, which nobody can change either.
    explicit SharedMemory(std::span<const std::byte> bytes);
    SharedMemory(SharedMemory&& other) noexcept
        : fd_(std::exchange(other.fd_, -1)),
          size_(other.size_),
          mapped_(std::exchange(other.mapped_, {}))
    {
    }
    SharedMemory& operator=(SharedMemory&&) = delete;
    ~SharedMemory();

    int descriptor() const { return fd_; }
    std::uint64_t size() const { return size_; }

    /// From now on nobody can change it. False if somebody may: it is mapped for writing, or was
    /// sealed against our sealing it.
    bool seal();

    /// Where writes one after another have come to, through all the descriptors that are copies of
    /// ours; nothing is known of what lies before if somebody sought or mapped.
    std::uint64_t written() const;

    /// Its first bytes, for as long as this object lives; `size` is at most its length. Once only,
    /// and sealed before: what is checked must not change afterwards.
    std::span<const std::byte> map(std::uint64_t size);

  private:
    int fd_ = -1;
    std::uint64_t size_ = 0;
    std::span<const std::byte> mapped_;
};

}  // namespace relight
