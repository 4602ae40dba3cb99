// relight-import exr [--memory BYTES] [--cpu-seconds N] [--pixels N] < file | …
// Decodes a client's file, shut in: see sandbox.h, and protocol.h for what comes out. Standard
// output must be no plain file: this process may not let one grow.
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "server/import/exr.h"
#include "server/import/protocol.h"
#include "server/import/sandbox.h"

namespace relight {
namespace {

constexpr int usage_error = 64, machine_error = 70;  // as sysexits.h has them

struct Arguments {
    SandboxLimits limits;
    std::uint64_t pixels = 1ULL << 25U;
};

/// Nothing if they are not understood.
std::optional<Arguments> parse(std::span<const char* const> words)
{
    Arguments arguments;
    if (words.size() % 2 != 0 || words.size() < 2 || std::string_view(words[1]) != "exr") {
        return std::nullopt;
    }
    for (std::size_t i = 2; i < words.size(); i += 2) {
        const std::string_view name = words[i], value = words[i + 1];
        std::uint64_t* const target = name == "--memory"        ? &arguments.limits.memory
                                      : name == "--cpu-seconds" ? &arguments.limits.cpu_seconds
                                      : name == "--pixels"      ? &arguments.pixels
                                                                : nullptr;
        if (target == nullptr) { return std::nullopt; }
        const char* const end = value.data() + value.size();
        const auto [at, failure] = std::from_chars(value.data(), end, *target);
        if (failure != std::errc{} || at != end) { return std::nullopt; }
    }
    return arguments;
}

/// All of standard input; nothing if reading failed.
std::optional<std::vector<std::byte>> read_all()
{
    std::vector<std::byte> file(1U << 20U);
    for (std::size_t size = 0;;) {
        const ssize_t count = ::read(STDIN_FILENO, file.data() + size, file.size() - size);
        if (count < 0 && errno == EINTR) { continue; }
        if (count < 0) { return std::nullopt; }
        size += static_cast<std::size_t>(count);
        if (count == 0) {
            file.resize(size);
            return file;
        }
        if (size == file.size()) { file.resize(2 * size); }
    }
}

bool write_all(int fd, std::span<const std::byte> bytes)
{
    while (!bytes.empty()) {
        const ssize_t count = ::write(fd, bytes.data(), bytes.size());
        if (count < 0 && errno == EINTR) { continue; }
        if (count < 0) { return false; }
        bytes = bytes.subspan(static_cast<std::size_t>(count));
    }
    return true;
}

bool write_all(int fd, std::string_view text)
{
    return write_all(fd, std::as_bytes(std::span(text)));
}

int refuse(Fault fault, std::string_view detail)
{
    std::string line = std::string(fault_code(fault)) + ' ';
    line += detail.substr(0, import_protocol::longest_refusal - line.size() - 1);
    return write_all(STDOUT_FILENO, line + '\n') ? import_protocol::refused : machine_error;
}

int import_file(const Arguments& arguments)
{
    const auto file = read_all();
    if (!file) { return machine_error; }
    const Result<DecodedImage> decoded = decode_exr(*file, arguments.pixels);
    if (!decoded) { return refuse(decoded.error().fault, decoded.error().detail); }
    const Image& image = decoded->image;
    const import_protocol::ImageHeader header{
        import_protocol::image_magic, static_cast<std::uint32_t>(image.width),
        static_cast<std::uint32_t>(image.height), decoded->negatives};
    const bool written = write_all(STDOUT_FILENO, std::as_bytes(std::span(&header, 1))) &&
                         write_all(STDOUT_FILENO, std::as_bytes(std::span(image.pixels)));
    return written ? import_protocol::imported : machine_error;
}

int run(std::span<const char* const> words)
{
    const auto arguments = parse(words);
    if (!arguments) {
        write_all(STDERR_FILENO,
                  "relight-import exr [--memory BYTES] [--cpu-seconds N] [--pixels N]\n");
        return usage_error;
    }
    prepare_exr();
    switch (enter_sandbox(arguments->limits)) {
        case Sandbox::Closed:
            break;
        case Sandbox::LimitsOnly:
            write_all(STDERR_FILENO,
                      "relight-import: limits hold, but system calls are not filtered here\n");
            break;
        case Sandbox::Failed:
            write_all(STDERR_FILENO, "relight-import: cannot limit itself; nothing is read\n");
            return machine_error;
    }
    try {
        return import_file(*arguments);
    } catch (const std::bad_alloc&) {
        return refuse(Fault::ImportFailed, "decoding the file takes more memory than the " +
                                               std::to_string(arguments->limits.memory >> 20U) +
                                               " MiB it may have");
    }
}

}  // namespace
}  // namespace relight

int main(int argc, char** argv)
{
    // No destructors at the end: they have nothing to do that the kernel does not.
    std::_Exit(relight::run({argv, static_cast<std::size_t>(argc)}));
}
