#include "server/importer.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>

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

/// What the importer says, as it arrives: a header and the content that it announces, or a line of
/// text. It may have been taken over by the file, so nothing it says is believed.
class Answer {
  public:
    explicit Answer(const ContentRoom& room) : room_for_(room) {}

    /// Where the next bytes go; never empty.
    std::span<std::byte> room()
    {
        if (!content_) { return std::as_writable_bytes(std::span(text_)).subspan(text_size_); }
        const auto left = content_->subspan(content_size_);
        return left.empty() ? std::span(&beyond_, 1) : left;
    }

    /// `count` bytes came there; false if they cannot be part of any answer.
    bool take(std::size_t count)
    {
        if (content_) {
            content_size_ += count;
            return content_size_ <= content_->size();
        }
        text_size_ += count;
        if (text_size_ < sizeof(protocol::Header)) { return true; }
        if (!std::equal(protocol::magic.begin(), protocol::magic.end(), text_.begin())) {
            return text_size_ < text_.size();
        }
        return begin_content();
    }

    /// Nothing if the content is there wholly; what to say of an importer that broke is `broken`.
    Failure finish(int status, Error broken) const;

  private:
    bool begin_content();
    std::optional<Error> refusal() const;

    const ContentRoom& room_for_;
    std::array<char, protocol::longest_refusal + 1> text_{};
    std::size_t text_size_ = 0;
    std::optional<std::span<std::byte>> content_;
    std::size_t content_size_ = 0;  // of what came
    std::byte beyond_{};            // a byte too many
};

bool Answer::begin_content()
{
    protocol::Header header;
    std::memcpy(&header, text_.data(), sizeof header);
    content_ = room_for_(header);
    const std::size_t early = text_size_ - sizeof header;  // content that came with the header
    if (!content_ || early > content_->size()) { return false; }
    std::memcpy(content_->data(), text_.data() + sizeof header, early);
    content_size_ = early;
    return true;
}

Failure Answer::finish(int status, Error broken) const
{
    const int said = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    if (said == protocol::imported && content_ && content_size_ == content_->size()) { return {}; }
    if (said == protocol::refused && !content_) { return refusal().value_or(std::move(broken)); }
    return broken;
}

/// "code detail": the codes that a decoder may give, and text that a client may be shown.
std::optional<Error> Answer::refusal() const
{
    constexpr std::array faults{
        Fault::MalformedHeader,     Fault::MalformedBody,      Fault::Truncated,
        Fault::OutOfRange,          Fault::NotAvailable,       Fault::NotFinite,
        Fault::JsonTooDeep,         Fault::CountExceedsFile,   Fault::IndexOutOfRange,
        Fault::NonFiniteCoordinate, Fault::CoordinateTooLarge, Fault::NoGeometry,
        Fault::TooManyVertices,     Fault::TooManyFaces,       Fault::ImportFailed};
    const std::string_view line(text_.data(), text_size_);
    const std::size_t blank = std::min(line.find(' '), line.size());
    for (const Fault fault : faults) {
        if (line.substr(0, blank) != fault_code(fault) || !line.ends_with('\n')) { continue; }
        std::string detail(line.substr(blank + 1, line.size() - blank - 2));
        std::replace_if(
            detail.begin(), detail.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
        return error(fault, std::move(detail));
    }
    return {};
}

std::string default_program()
{
    return (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "relight-import")
        .string();
}

std::vector<std::string> arguments(const ImportKind& kind, std::size_t bytes,
                                   const ImportLimits& limits)
{
    const auto cpu_seconds = std::chrono::ceil<std::chrono::seconds>(limits.time).count();
    return {
        std::string(kind.name),        "--bytes",       std::to_string(bytes),           "--memory",
        std::to_string(limits.memory), "--cpu-seconds", std::to_string(cpu_seconds),     "--pixels",
        std::to_string(limits.pixels), "--vertices",    std::to_string(limits.vertices), "--faces",
        std::to_string(limits.faces)};
}

}  // namespace

Error broken_import(const ImportKind& kind)
{
    return error(Fault::ImportFailed,
                 "the decoder broke on this file's content; " + std::string(kind.remedy));
}

Result<Done> run_importer(const ImportKind& kind, std::span<const std::byte> file,
                          const ImportLimits& limits, Progress& progress, const ContentRoom& room)
{
    if (file.empty()) { return error(Fault::EmptyFile, "the file has no bytes"); }
    const Clock::time_point deadline = Clock::now() + limits.time;
    ImportProcess process(limits.program.empty() ? default_program() : limits.program,
                          arguments(kind, file.size(), limits));
    const auto out_of_patience = [&]() -> Failure {
        if (progress.stopped()) { return error(Fault::Cancelled, "the import was stopped"); }
        if (Clock::now() < deadline) { return {}; }
        return error(Fault::ImportFailed, "decoding the file takes longer than the " +
                                              std::to_string(limits.time.count()) +
                                              " ms it may take");
    };

    // Sends and receives as either is possible: the importer may speak before it has heard all.
    Answer answer(room);
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
            const std::span<std::byte> next = answer.room();
            const ssize_t count = ::recv(process.socket(), next.data(), next.size(), MSG_DONTWAIT);
            if (count > 0 && !answer.take(static_cast<std::size_t>(count))) {
                return broken_import(kind);
            }
            open = count > 0 || (count < 0 && (errno == EAGAIN || errno == EINTR));
        }
    }
    for (;;) {
        if (const auto status = process.ended()) {
            if (auto failure = answer.finish(*status, broken_import(kind))) { return *failure; }
            return Done{};
        }
        if (auto failure = out_of_patience()) { return std::move(*failure); }
        std::this_thread::sleep_for(std::chrono::microseconds{200});
    }
}

}  // namespace relight
