#include "server/file.h"

#include <fcntl.h>
#include <sys/stat.h>
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

File::File(const std::filesystem::path& path, int flags)
    : fd_(::open(path.c_str(), flags | O_CLOEXEC, 0600))
{
    if (fd_ < 0) { fail("open"); }
}

File::~File()
{
    if (fd_ >= 0) { ::close(fd_); }
}

std::uint64_t File::size() const
{
    struct stat status = {};
    if (::fstat(fd_, &status) != 0) { fail("fstat"); }
    return static_cast<std::uint64_t>(status.st_size);
}

void File::write(std::string_view bytes)
{
    while (!bytes.empty()) {
        const ssize_t written = ::write(fd_, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) { continue; }
        if (written < 0) { fail("write"); }
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
}

void File::sync()
{
    if (::fsync(fd_) != 0) { fail("fsync"); }
}

std::size_t File::read_at(std::uint64_t offset, std::span<std::byte> into) const
{
    std::size_t done = 0;
    while (done < into.size()) {
        const ssize_t got =
            ::pread(fd_, into.data() + done, into.size() - done, static_cast<off_t>(offset + done));
        if (got < 0 && errno == EINTR) { continue; }
        if (got < 0) { fail("pread"); }
        if (got == 0) { break; }
        done += static_cast<std::size_t>(got);
    }
    return done;
}

std::vector<std::byte> File::read_all() const
{
    std::vector<std::byte> bytes(size());
    bytes.resize(read_at(0, bytes));
    return bytes;
}

}  // namespace relight
