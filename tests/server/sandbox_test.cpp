#include "server/import/sandbox.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <new>

namespace relight::test {
namespace {

constexpr int as_limits_only = 77;

/// In a process of its own: shut in, then `act`, whose answer is the exit status.
void in_sandbox(const SandboxLimits& limits, const std::function<int()>& act, bool needs_filter)
{
    const Sandbox sandbox = enter_sandbox(limits);
    if (sandbox == Sandbox::Failed) { std::_Exit(78); }
    if (needs_filter && sandbox != Sandbox::Closed) { std::_Exit(as_limits_only); }
    std::_Exit(act());
}

/// Killed by the kernel for the call, or there is no filter here (a sanitizer, an old kernel).
bool killed_for_a_call(int status)
{
    if (WIFEXITED(status) && WEXITSTATUS(status) == as_limits_only) {
        std::puts("no filter of system calls here");
        return true;
    }
    return WIFSIGNALED(status) && WTERMSIG(status) == SIGSYS;
}

TEST(Sandbox, KillsForAnyCallBeyondWritingAndMemory)
{
    const std::function<int()> calls[] = {[] { return ::open("/dev/null", O_RDONLY); },
                                          [] { return ::socket(AF_INET, SOCK_STREAM, 0); },
                                          [] { return ::fork(); },
                                          [] { return ::execl("/bin/true", "true", nullptr); },
                                          [] { return ::kill(::getppid(), 0); },
                                          [] { return ::dup(0); },
                                          [] {
                                              char byte = 0;
                                              return static_cast<int>(::read(0, &byte, 1));
                                          },
                                          [] { return ::prctl(PR_SET_DUMPABLE, 1, 0, 0, 0); },
                                          [] {
                                              return ::mmap(nullptr, 4096, PROT_READ | PROT_EXEC,
                                                            MAP_PRIVATE | MAP_ANONYMOUS, -1,
                                                            0) == MAP_FAILED;
                                          }};
    int place = 0;
    for (const auto& call : calls) {
        EXPECT_EXIT(in_sandbox({}, call, true), killed_for_a_call, "") << place;
        ++place;
    }
}

TEST(Sandbox, LetsMemoryBeHadUpToItsBound)
{
    const auto take = [](std::size_t megabytes) {
        return [megabytes] {
            void* const memory = std::malloc(megabytes << 20U);
            if (memory == nullptr) { return 1; }
            static_cast<volatile char*>(memory)[0] = 1;
            return 0;
        };
    };
    EXPECT_EXIT(in_sandbox({.memory = 512ULL << 20U}, take(256), false),
                ::testing::ExitedWithCode(0), "");
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    EXPECT_EXIT(in_sandbox({.memory = 512ULL << 20U}, take(600), false),
                ::testing::ExitedWithCode(1), "");
#endif
}

TEST(Sandbox, LetsNoFileGrowBeyondItsBound)
{
    const auto write = [](ssize_t bytes) {
        return [bytes] {
            const std::array<char, 1000> zeros{};
            return ::write(STDOUT_FILENO, zeros.data(), static_cast<std::size_t>(bytes)) == bytes &&
                           ::write(STDOUT_FILENO, zeros.data(), 1) == 1
                       ? 0
                       : 1;
        };
    };
    const auto after = [](const std::function<int()>& act) {
        ::dup2(::memfd_create("output", 0), STDOUT_FILENO);
        in_sandbox({.output = 1000}, act, false);
    };
    EXPECT_EXIT(after(write(999)), ::testing::ExitedWithCode(0), "");
    EXPECT_EXIT(after(write(1000)), ::testing::KilledBySignal(SIGXFSZ), "");
}

TEST(Sandbox, EndsEndlessWork)
{
    const auto killed = [](int status) {
        return WIFSIGNALED(status) && (WTERMSIG(status) == SIGKILL || WTERMSIG(status) == SIGXCPU);
    };
    const auto work = [] {
        const volatile bool more = true;
        while (more) {}
        return 0;
    };
    EXPECT_EXIT(in_sandbox({.cpu_seconds = 1}, work, false), killed, "");
}

}  // namespace
}  // namespace relight::test
