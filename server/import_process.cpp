#include "server/import_process.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

#include "server/import/protocol.h"

namespace relight {
namespace {

namespace protocol = import_protocol;
using Clock = std::chrono::steady_clock;
using Failure = std::optional<Error>;

constexpr std::chrono::milliseconds look_around{20};  // between two looks at Progress

Error error(Fault fault, std::string detail)
{
    return {fault, std::move(detail), {}, {}, {}};
}

/// The importer at work: our end of a socket that is its standard input and output. (A socket, for
/// send() raises no SIGPIPE.) Whatever happens, nothing of it outlives this object.
class ImportProcess {
  public:
    ImportProcess(const std::string& program, std::vector<std::string> arguments);
    ~ImportProcess();
    ImportProcess(const ImportProcess&) = delete;
    ImportProcess& operator=(const ImportProcess&) = delete;

    int socket() const { return socket_; }

    /// Its exit status as waitpid() has it, once it has ended.
    std::optional<int> ended();

  private:
    pid_t process_ = -1;  // and its process group; -1 once it has ended
    int socket_ = -1;
};

void check(int code, const char* what)
{
    if (code != 0) { throw std::system_error(code, std::generic_category(), what); }
}

ImportProcess::ImportProcess(const std::string& program, std::vector<std::string> arguments)
{
    std::array<int, 2> ends{};
    check(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) == 0 ? 0 : errno,
          "socketpair");
    socket_ = ends[0];

    // Of what this process has open it gets that socket alone, and none of its environment, blocked
    // signals or terminal.
    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;
    sigset_t none, all;
    ::sigemptyset(&none);
    ::sigfillset(&all);
    ::posix_spawn_file_actions_init(&files);
    ::posix_spawnattr_init(&attributes);
    ::posix_spawn_file_actions_adddup2(&files, ends[1], STDIN_FILENO);
    ::posix_spawn_file_actions_adddup2(&files, ends[1], STDOUT_FILENO);
    ::posix_spawn_file_actions_addopen(&files, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    ::posix_spawn_file_actions_addclosefrom_np(&files, STDERR_FILENO + 1);
    ::posix_spawnattr_setsigmask(&attributes, &none);
    ::posix_spawnattr_setsigdefault(&attributes, &all);
    ::posix_spawnattr_setpgroup(&attributes, 0);
    ::posix_spawnattr_setflags(
        &attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
    arguments.insert(arguments.begin(), program);
    std::vector<char*> argv;
    argv.reserve(arguments.size() + 1);
    for (std::string& argument : arguments) { argv.push_back(argument.data()); }
    argv.push_back(nullptr);
    char* environment[] = {nullptr};
    pid_t process = -1;
    const int code =
        ::posix_spawn(&process, program.c_str(), &files, &attributes, argv.data(), environment);
    ::posix_spawnattr_destroy(&attributes);
    ::posix_spawn_file_actions_destroy(&files);
    ::close(ends[1]);
    if (code != 0) { ::close(socket_); }
    check(code, "start of relight-import");
    process_ = process;
}

ImportProcess::~ImportProcess()
{
    ::close(socket_);
    if (process_ < 0) { return; }
    ::kill(-process_, SIGKILL);
    while (::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {}
}

std::optional<int> ImportProcess::ended()
{
    siginfo_t end{};
    const int flags = WEXITED | WNOHANG | WNOWAIT;
    if (::waitid(P_PID, static_cast<id_t>(process_), &end, flags) != 0 || end.si_pid == 0) {
        return std::nullopt;
    }
    ::kill(-process_, SIGKILL);  // what it may have left behind, while the group's name is its own
    int status = 0;
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {}
    process_ = -1;
    return status;
}

/// What the importer says, as it arrives: a picture of an announced size, or a line of text. It may
/// have been taken over by the file, so nothing it says is believed.
class Answer {
  public:
    explicit Answer(std::uint64_t most_pixels) : most_pixels_(most_pixels) {}

    /// Where the next bytes go; never empty.
    std::span<std::byte> room()
    {
        if (!is_image_) { return std::as_writable_bytes(std::span(text_)).subspan(text_size_); }
        const auto pixels = std::as_writable_bytes(std::span(image_.pixels)).subspan(pixel_bytes_);
        return pixels.empty() ? std::span(&beyond_, 1) : pixels;
    }

    /// `count` bytes came there; false if they cannot be part of any answer.
    bool take(std::size_t count)
    {
        if (is_image_) {
            pixel_bytes_ += count;
            return pixel_bytes_ <= image_.pixels.size() * sizeof(Rgbf);
        }
        text_size_ += count;
        if (text_size_ < sizeof(protocol::ImageHeader)) { return true; }
        if (!std::equal(protocol::image_magic.begin(), protocol::image_magic.end(),
                        text_.begin())) {
            return text_size_ < text_.size();
        }
        return begin_image();
    }

    Result<ImportedImage> finish(int status) &&;

  private:
    bool begin_image();
    Result<ImportedImage> picture() &&;
    Error refusal() const;

    std::uint64_t most_pixels_;
    std::array<char, protocol::longest_refusal + 1> text_{};
    std::size_t text_size_ = 0;
    bool is_image_ = false;
    Image image_;
    std::uint64_t negatives_ = 0;
    std::size_t pixel_bytes_ = 0;  // of those that came
    std::byte beyond_{};           // a byte too many
};

bool Answer::begin_image()
{
    protocol::ImageHeader header;
    std::memcpy(&header, text_.data(), sizeof header);
    if (header.width < 1 || header.height < 1 || header.width > most_pixels_ / header.height) {
        return false;
    }
    is_image_ = true;
    negatives_ = header.negatives;
    image_.width = static_cast<int>(header.width);
    image_.height = static_cast<int>(header.height);
    image_.pixels.resize(std::size_t{header.width} * header.height);
    const std::size_t early = text_size_ - sizeof header;  // pixels that came with the header
    if (early > image_.pixels.size() * sizeof(Rgbf)) { return false; }
    std::memcpy(image_.pixels.data(), text_.data() + sizeof header, early);
    pixel_bytes_ = early;
    return true;
}

Error broken()
{
    return error(Fault::ImportFailed,
                 "the decoder broke on this file's content; write it anew with another program, or "
                 "send a Radiance .hdr");
}

Result<ImportedImage> Answer::finish(int status) &&
{
    if (!WIFEXITED(status)) { return broken(); }
    if (WEXITSTATUS(status) == protocol::refused && !is_image_) { return refusal(); }
    if (WEXITSTATUS(status) == protocol::imported && is_image_) {
        return std::move(*this).picture();
    }
    return broken();
}

Result<ImportedImage> Answer::picture() &&
{
    const auto good = [](const Rgbf& texel) {
        return std::all_of(texel.begin(), texel.end(),
                           [](float v) { return v >= 0.0F && std::isfinite(v); });
    };
    if (pixel_bytes_ != image_.pixels.size() * sizeof(Rgbf) ||
        !std::all_of(image_.pixels.begin(), image_.pixels.end(), good)) {
        return broken();
    }
    ImportedImage imported{std::move(image_), {}};
    if (negatives_ > 0) {
        imported.notes.push_back(std::to_string(negatives_) + " values below 0 became 0");
    }
    return imported;
}

/// "code detail": the codes that a decoder may give, and text that a client may be shown.
Error Answer::refusal() const
{
    constexpr std::array faults{Fault::MalformedHeader, Fault::MalformedBody, Fault::Truncated,
                                Fault::OutOfRange,      Fault::NotAvailable,  Fault::NotFinite,
                                Fault::ImportFailed};
    const std::string_view line(text_.data(), text_size_);
    const std::size_t blank = std::min(line.find(' '), line.size());
    for (const Fault fault : faults) {
        if (line.substr(0, blank) != fault_code(fault) || !line.ends_with('\n')) { continue; }
        std::string detail(line.substr(blank + 1, line.size() - blank - 2));
        std::replace_if(
            detail.begin(), detail.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
        return error(fault, std::move(detail));
    }
    return broken();
}

std::string default_program()
{
    return (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "relight-import")
        .string();
}

}  // namespace

Result<ImportedImage> import_exr(std::span<const std::byte> file, const ImportLimits& limits,
                                 Progress& progress)
{
    if (file.empty()) { return error(Fault::EmptyFile, "the file has no bytes"); }
    const Clock::time_point deadline = Clock::now() + limits.time;
    const auto cpu_seconds = std::chrono::ceil<std::chrono::seconds>(limits.time).count();
    ImportProcess process(limits.program.empty() ? default_program() : limits.program,
                          {"exr", "--memory", std::to_string(limits.memory), "--cpu-seconds",
                           std::to_string(cpu_seconds), "--pixels", std::to_string(limits.pixels)});
    const auto out_of_patience = [&]() -> Failure {
        if (progress.stopped()) { return error(Fault::Cancelled, "the import was stopped"); }
        if (Clock::now() < deadline) { return {}; }
        return error(Fault::ImportFailed, "decoding the file takes longer than the " +
                                              std::to_string(limits.time.count()) +
                                              " ms it may take");
    };

    // Sends and receives as either is possible: the importer may speak before it has heard all.
    Answer answer(limits.pixels);
    for (bool open = true; open;) {
        if (auto failure = out_of_patience()) { return std::move(*failure); }
        pollfd events{process.socket(), POLLIN, 0};
        if (!file.empty()) { events.events |= POLLOUT; }
        if (::poll(&events, 1, static_cast<int>(look_around.count())) <= 0) { continue; }
        if ((events.revents & POLLOUT) != 0) {
            const ssize_t sent =
                ::send(process.socket(), file.data(), file.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
            if (sent > 0) { file = file.subspan(static_cast<std::size_t>(sent)); }
            if (sent < 0 && errno != EAGAIN && errno != EINTR) { file = {}; }  // it wants no more
            if (file.empty()) { ::shutdown(process.socket(), SHUT_WR); }
        }
        if ((events.revents & (POLLIN | POLLHUP | POLLERR)) != 0) {
            const std::span<std::byte> room = answer.room();
            const ssize_t count = ::recv(process.socket(), room.data(), room.size(), MSG_DONTWAIT);
            if (count > 0 && !answer.take(static_cast<std::size_t>(count))) { return broken(); }
            open = count > 0 || (count < 0 && (errno == EAGAIN || errno == EINTR));
        }
    }
    for (;;) {
        if (const auto status = process.ended()) { return std::move(answer).finish(*status); }
        if (auto failure = out_of_patience()) { return std::move(*failure); }
        std::this_thread::sleep_for(std::chrono::microseconds{200});
    }
}

Result<Asset> import_gltf(std::span<const std::byte> /*file*/, const ImportLimits& /*limits*/,
                          Progress& /*progress*/)
{
    return error(Fault::NotAvailable, "glTF is not read yet");
}

}  // namespace relight
