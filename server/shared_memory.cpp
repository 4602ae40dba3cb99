#include "server/shared_memory.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace relight {
namespace {

[[noreturn]] void fail(const char* what)
{
    throw std::system_error(errno, std::generic_category(), what);
}

}  // namespace

SharedMemory::SharedMemory(std::uint64_t size)
    : fd_(::memfd_create("relight", MFD_CLOEXEC | MFD_ALLOW_SEALING)), size_(size)
{
    if (fd_ < 0) { fail("memfd_create"); }
    if (::ftruncate(fd_, static_cast<off_t>(size)) != 0 ||
        ::fcntl(fd_, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW) != 0) {
        ::close(fd_);
        fail("memory to share");
    }
}

SharedMemory::SharedMemory(std::span<const std::byte> bytes) : SharedMemory(bytes.size())
{
    for (std::size_t at = 0; at < bytes.size();) {  // pwrite: its reader begins at the beginning
        const ssize_t count =
            ::pwrite(fd_, bytes.data() + at, bytes.size() - at, static_cast<off_t>(at));
        if (count < 0 && errno != EINTR) { fail("write to memory"); }
        if (count > 0) { at += static_cast<std::size_t>(count); }
    }
    if (!seal()) { fail("seal of memory"); }
}

SharedMemory::~SharedMemory()
{
    if (!mapped_.empty()) {
        ::munmap(const_cast<std::byte*>(mapped_.data()), mapped_.size());  // NOLINT: as mapped
    }
    if (fd_ >= 0) { ::close(fd_); }
}

bool SharedMemory::seal()
{
    return ::fcntl(fd_, F_ADD_SEALS, F_SEAL_WRITE | F_SEAL_SEAL) == 0;
}

std::uint64_t SharedMemory::written() const
{
    const off_t at = ::lseek(fd_, 0, SEEK_CUR);
    if (at < 0) { fail("lseek"); }
    return static_cast<std::uint64_t>(at);
}

std::span<const std::byte> SharedMemory::map(std::uint64_t size)
{
    if (size == 0) { return {}; }
    void* const at = ::mmap(nullptr, size, PROT_READ, MAP_SHARED | MAP_POPULATE, fd_, 0);
    if (at == MAP_FAILED) { fail("map of memory"); }
    mapped_ = {static_cast<const std::byte*>(at), size};
    return mapped_;
}

}  // namespace relight
