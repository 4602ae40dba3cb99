#include "server/importer.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

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

/// The importer at work. Whatever happens, nothing of it outlives this object.
class ImportProcess {
  public:
    /// Its standard input and output are these files. All else that this process has it has not:
    /// no other file, none of the environment, blocked signals or terminal.
    ImportProcess(const std::string& program, std::vector<std::string> arguments, int input,
                  int output);
    ~ImportProcess();
    ImportProcess(const ImportProcess&) = delete;
    ImportProcess& operator=(const ImportProcess&) = delete;

    /// Its exit status as waitpid() has it, if it ends within this time.
    std::optional<int> ended_within(std::chrono::milliseconds time);

  private:
    ImportProcess() = default;

    pid_t process_ = -1;  // and its process group; -1 once it has ended
    int end_ = -1;        // a file that can be read from once it has
};

void check(int code, const char* what)
{
    if (code != 0) { throw std::system_error(code, std::generic_category(), what); }
}

ImportProcess::ImportProcess(const std::string& program, std::vector<std::string> arguments,
                             int input, int output)
    : ImportProcess()  // so that what throws from here on leaves no process behind
{
    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;
    sigset_t none, all;
    ::sigemptyset(&none);
    ::sigfillset(&all);
    ::posix_spawn_file_actions_init(&files);
    ::posix_spawnattr_init(&attributes);
    ::posix_spawn_file_actions_adddup2(&files, input, STDIN_FILENO);
    ::posix_spawn_file_actions_adddup2(&files, output, STDOUT_FILENO);
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
    // Its memory comes in large pages and never goes back: without, a third of the time that
    // decoding a million vertices takes is page faults.
    char tunables[] =
        "GLIBC_TUNABLES=glibc.malloc.hugetlb=1:glibc.malloc.mmap_max=0:"
        "glibc.malloc.top_pad=8388608:glibc.malloc.trim_threshold=4294967296";
    char* environment[] = {tunables, nullptr};
    pid_t process = -1;
    const int code =
        ::posix_spawn(&process, program.c_str(), &files, &attributes, argv.data(), environment);
    ::posix_spawnattr_destroy(&attributes);
    ::posix_spawn_file_actions_destroy(&files);
    check(code, "start of relight-import");
    process_ = process;
    end_ = static_cast<int>(::syscall(SYS_pidfd_open, process, 0));  // the C library's is C only
    check(end_ < 0 ? errno : 0, "pidfd_open");
}

ImportProcess::~ImportProcess()
{
    if (end_ >= 0) { ::close(end_); }
    if (process_ < 0) { return; }
    ::kill(-process_, SIGKILL);
    while (::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {}
}

std::optional<int> ImportProcess::ended_within(std::chrono::milliseconds time)
{
    pollfd end{end_, POLLIN, 0};
    if (::poll(&end, 1, static_cast<int>(time.count())) <= 0) { return std::nullopt; }
    ::kill(-process_, SIGKILL);  // what it may have left behind, while the group's name is its own
    int status = 0;
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {}
    process_ = -1;
    return status;
}

/// "code detail": the codes that a decoder may give, and text that a client may be shown.
std::optional<Error> refusal(std::span<const std::byte> bytes)
{
    constexpr std::array faults{
        Fault::MalformedHeader,     Fault::MalformedBody,      Fault::Truncated,
        Fault::OutOfRange,          Fault::NotAvailable,       Fault::NotFinite,
        Fault::JsonTooDeep,         Fault::CountExceedsFile,   Fault::IndexOutOfRange,
        Fault::NonFiniteCoordinate, Fault::CoordinateTooLarge, Fault::NoGeometry,
        Fault::TooManyVertices,     Fault::TooManyFaces,       Fault::ImportFailed};
    const std::string_view line(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (line.size() > protocol::longest_refusal || !line.ends_with('\n')) { return {}; }
    const std::size_t blank = std::min(line.find(' '), line.size() - 1);
    for (const Fault fault : faults) {
        if (line.substr(0, blank) != fault_code(fault)) { continue; }
        std::string detail(line.substr(blank + 1, line.size() - blank - 2));
        std::replace_if(
            detail.begin(), detail.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
        return error(fault, std::move(detail));
    }
    return {};
}

/// An importer that has ended with `status`: reads what it has left in `answer.memory`.
Failure read_answer(ImportAnswer& answer, int status, Error broken)
{
    const int said = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    if (said != protocol::imported && said != protocol::refused) { return broken; }
    // Sealed first: should anything of it live on, then nothing of what is read can change.
    const std::uint64_t size = answer.memory.written();
    if (size > answer.memory.size() || !answer.memory.seal()) { return broken; }
    const std::span<const std::byte> bytes = answer.memory.map(size);
    if (said == protocol::refused) { return refusal(bytes).value_or(std::move(broken)); }
    protocol::Header& header = answer.header;
    if (size < sizeof header) { return broken; }
    std::memcpy(&header, bytes.data(), sizeof header);
    answer.content = bytes.subspan(sizeof header);
    if (header.magic != protocol::magic || header.bytes != answer.content.size()) { return broken; }
    return {};
}

std::string default_program()
{
    return (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "relight-import")
        .string();
}

std::vector<std::string> arguments(const ImportKind& kind, const ImportLimits& limits,
                                   std::uint64_t output)
{
    const auto cpu_seconds = std::chrono::ceil<std::chrono::seconds>(limits.time).count();
    return {
        std::string(kind.name),        "--output",      std::to_string(output),          "--memory",
        std::to_string(limits.memory), "--cpu-seconds", std::to_string(cpu_seconds),     "--pixels",
        std::to_string(limits.pixels), "--vertices",    std::to_string(limits.vertices), "--faces",
        std::to_string(limits.faces)};
}

}  // namespace

/// A decoder has one thread and up to ImportLimits::memory: more of them than cores would be done
/// no sooner, but take more memory.
class ImportPlaces {
  public:
    /// Nothing if we are stopped before there is one.
    static ImportPlace take(const Progress& progress)
    {
        static ImportPlaces places;
        std::unique_lock lock(places.mutex_);
        while (!places.changed_.wait_for(lock, look_around, [&] { return places.free_ > 0; })) {
            if (progress.stopped()) { return {}; }
        }
        --places.free_;
        return ImportPlace(&places);
    }

    void give_back()
    {
        const std::lock_guard lock(mutex_);
        ++free_;
        changed_.notify_one();
    }

  private:
    std::mutex mutex_;
    std::condition_variable changed_;
    unsigned free_ = std::max(1U, std::thread::hardware_concurrency());
};

void GiveBack::operator()(ImportPlaces* places) const
{
    places->give_back();
}

Error broken_import(const ImportKind& kind)
{
    return error(Fault::ImportFailed,
                 "the decoder broke on this file's content; " + std::string(kind.remedy));
}

Result<ImportAnswer> run_importer(const ImportKind& kind, std::span<const std::byte> file,
                                  const ImportLimits& limits, Progress& progress)
{
    if (file.empty()) { return error(Fault::EmptyFile, "the file has no bytes"); }
    const Error stopped = error(Fault::Cancelled, "the import was stopped");
    ImportPlace place = ImportPlaces::take(progress);
    if (!place) { return stopped; }

    const Clock::time_point deadline = Clock::now() + limits.time;
    // The importer has held in its own memory what it says.
    const std::uint64_t most = std::max<std::uint64_t>(limits.memory, protocol::longest_refusal) +
                               sizeof(protocol::Header);
    ImportAnswer answer{std::move(place), SharedMemory(most)};
    const SharedMemory input(file);
    ImportProcess process(limits.program.empty() ? default_program() : limits.program,
                          arguments(kind, limits, most), input.descriptor(),
                          answer.memory.descriptor());
    for (;;) {
        if (const auto status = process.ended_within(look_around)) {
            if (auto failure = read_answer(answer, *status, broken_import(kind))) {
                return std::move(*failure);
            }
            return answer;
        }
        if (progress.stopped()) { return stopped; }
        if (Clock::now() >= deadline) {
            return error(Fault::ImportFailed, "decoding the file takes longer than the " +
                                                  std::to_string(limits.time.count()) +
                                                  " ms it may take");
        }
    }
}

}  // namespace relight
