// relight-import exr|gltf [--output BYTES] [--memory BYTES] [--cpu-seconds N] [--pixels N]
//                [--vertices N] [--faces N] < file > answer
// Decodes a client's file, shut in: see sandbox.h, and protocol.h for what comes out. The file must
// be one that can be mapped, and no longer than it is now until this is done with it.
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstdlib>
#include <exception>
#include <iterator>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/import/archive.h"
#include "server/import/exr.h"
#include "server/import/gltf.h"
#include "server/import/protocol.h"
#include "server/import/sandbox.h"

namespace relight {
namespace {

constexpr int usage_error = 64, machine_error = 70;  // as sysexits.h has them

struct Arguments {
    std::string_view kind;
    SandboxLimits sandbox;
    GltfLimits limits;
};

/// Nothing if they are not understood.
std::optional<Arguments> parse(std::span<const char* const> words)
{
    if (words.size() % 2 != 0 || words.size() < 2) { return std::nullopt; }
    Arguments arguments;
    arguments.kind = words[1];
    if (arguments.kind != "exr" && arguments.kind != "gltf") { return std::nullopt; }
    const std::pair<std::string_view, std::uint64_t*> options[] = {
        {"--output", &arguments.sandbox.output},           {"--memory", &arguments.sandbox.memory},
        {"--cpu-seconds", &arguments.sandbox.cpu_seconds}, {"--pixels", &arguments.limits.pixels},
        {"--vertices", &arguments.limits.vertices},        {"--faces", &arguments.limits.faces}};
    for (std::size_t i = 2; i < words.size(); i += 2) {
        const std::string_view name = words[i], value = words[i + 1];
        const auto* const option = std::find_if(std::begin(options), std::end(options),
                                                [&](const auto& o) { return o.first == name; });
        if (option == std::end(options)) { return std::nullopt; }
        const char* const end = value.data() + value.size();
        const auto [at, failure] = std::from_chars(value.data(), end, *option->second);
        if (failure != std::errc{} || at != end) { return std::nullopt; }
    }
    return arguments;
}

/// Standard input, nowhere copied and not yet looked at; nothing if it is no file.
std::optional<std::span<const std::byte>> map_input()
{
    struct stat status = {};
    if (::fstat(STDIN_FILENO, &status) != 0 || !S_ISREG(status.st_mode)) { return std::nullopt; }
    const auto size = static_cast<std::size_t>(status.st_size);
    if (size == 0) { return std::span<const std::byte>(); }
    void* const at = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE | MAP_POPULATE, STDIN_FILENO, 0);
    if (at == MAP_FAILED) { return std::nullopt; }
    return std::span(static_cast<const std::byte*>(at), size);
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

bool write_header(std::uint64_t bytes, const DecodedImage& picture)
{
    const import_protocol::Header header{
        import_protocol::magic, bytes, static_cast<std::uint32_t>(picture.image.width),
        static_cast<std::uint32_t>(picture.image.height), picture.negatives};
    return write_all(STDOUT_FILENO, std::as_bytes(std::span(&header, 1)));
}

bool answer(const DecodedImage& decoded)
{
    const auto texels = std::as_bytes(std::span(decoded.image.pixels));
    return write_header(texels.size(), decoded) && write_all(STDOUT_FILENO, texels);
}

bool answer(const Asset& asset)
{
    std::uint64_t size = 0;
    const auto count = [&](std::span<const std::byte> bytes) {
        size += bytes.size();
        return true;
    };
    const auto write = [](std::span<const std::byte> bytes) {
        return write_all(STDOUT_FILENO, bytes);
    };
    return write_asset(asset, count) && write_header(size, {}) && write_asset(asset, write);
}

template <class T>
int finish(const Result<T>& decoded)
{
    if (!decoded) { return refuse(decoded.error().fault, decoded.error().detail); }
    return answer(*decoded) ? import_protocol::imported : machine_error;
}

int import_file(const Arguments& arguments, std::span<const std::byte> file)
{
    if (arguments.kind == "exr") { return finish(decode_exr(file, arguments.limits.pixels)); }
    return finish(decode_gltf(file, arguments.limits));
}

int run(std::span<const char* const> words)
{
    const auto arguments = parse(words);
    if (!arguments) {
        write_all(STDERR_FILENO,
                  "relight-import exr|gltf [--output BYTES] [--memory BYTES] [--cpu-seconds N] "
                  "[--pixels N] [--vertices N] [--faces N] < file\n");
        return usage_error;
    }
    const auto file = map_input();
    if (!file) {
        write_all(STDERR_FILENO, "relight-import: standard input is no file that can be mapped\n");
        return machine_error;
    }
    if (arguments->kind == "exr") { prepare_exr(); }
    switch (enter_sandbox(arguments->sandbox)) {
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
        return import_file(*arguments, *file);
    } catch (const std::bad_alloc&) {
        return refuse(Fault::ImportFailed, "decoding the file takes more memory than the " +
                                               std::to_string(arguments->sandbox.memory >> 20U) +
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
