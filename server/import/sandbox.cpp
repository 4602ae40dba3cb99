#include "server/import/sandbox.h"

#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <csignal>
#include <cstddef>
#include <vector>

namespace relight {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
// Shadow memory takes terabytes of addresses, and looking at them system calls and a pipe.
constexpr bool sanitized = true;
#else
constexpr bool sanitized = false;
#endif

#if defined(__x86_64__)
constexpr std::uint32_t native_calls = AUDIT_ARCH_X86_64;
#elif defined(__aarch64__)
constexpr std::uint32_t native_calls = AUDIT_ARCH_AARCH64;
#else
constexpr std::uint32_t native_calls = 0;  // of no kernel: the filter is not installed
#endif

bool limit(__rlimit_resource what, rlim_t most)
{
    const rlimit both{most, most};
    return ::setrlimit(what, &both) == 0;
}

/// What decoding from memory needs: bytes out, memory, mutexes, the clock, an end.
constexpr long allowed[] = {SYS_write,        SYS_munmap,    SYS_mremap,        SYS_madvise,
                            SYS_brk,          SYS_futex,     SYS_exit_group,    SYS_exit,
                            SYS_rt_sigreturn, SYS_getrandom, SYS_clock_gettime, SYS_gettimeofday,
                            SYS_sched_yield};

/// Memory may be had, but never to be run.
constexpr long allowed_without_exec[] = {SYS_mmap, SYS_mprotect};

/// The list as a program of the kernel's packet filter: each call is looked up, the rest kill.
std::vector<sock_filter> filter()
{
    constexpr auto load = [](std::size_t offset) {
        return sock_filter{BPF_LD | BPF_W | BPF_ABS, 0, 0, static_cast<std::uint32_t>(offset)};
    };
    constexpr auto answer = [](std::uint32_t what) {
        return sock_filter{BPF_RET | BPF_K, 0, 0, what};
    };
    // Goes on to the next instruction if equal (or if bits are set), else skips `n`.
    constexpr auto unless = [](std::uint16_t test, std::uint32_t value, std::uint8_t n) {
        return sock_filter{static_cast<std::uint16_t>(BPF_JMP | test | BPF_K), 0, n, value};
    };
    constexpr std::size_t protection =  // low half of the third argument of mmap and mprotect
        offsetof(seccomp_data, args) + 2 * sizeof(std::uint64_t);
    const sock_filter allow = answer(SECCOMP_RET_ALLOW), kill = answer(SECCOMP_RET_KILL_PROCESS);

    std::vector<sock_filter> program{load(offsetof(seccomp_data, arch)),
                                     {BPF_JMP | BPF_JEQ | BPF_K, 1, 0, native_calls},
                                     kill,
                                     load(offsetof(seccomp_data, nr))};
    for (const long call : allowed) {
        program.push_back(unless(BPF_JEQ, static_cast<std::uint32_t>(call), 1));
        program.push_back(allow);
    }
    for (const long call : allowed_without_exec) {
        program.push_back(unless(BPF_JEQ, static_cast<std::uint32_t>(call), 4));
        program.push_back(load(protection));
        program.push_back(unless(BPF_JSET, PROT_EXEC, 1));
        program.push_back(kill);
        program.push_back(allow);
    }
    program.push_back(kill);
    return program;
}

bool install_filter()
{
    if (sanitized || native_calls == 0) { return false; }
    std::vector<sock_filter> instructions = filter();
    const sock_fprog program{static_cast<unsigned short>(instructions.size()), instructions.data()};
    return ::syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, 0, &program) == 0;
}

}  // namespace

Sandbox enter_sandbox(const SandboxLimits& limits)
{
    const bool limited =
        (sanitized || limit(RLIMIT_AS, limits.memory)) && limit(RLIMIT_CPU, limits.cpu_seconds) &&
        limit(RLIMIT_FSIZE, limits.output) && limit(RLIMIT_CORE, 0) && limit(RLIMIT_NPROC, 0) &&
        (sanitized || limit(RLIMIT_NOFILE, 3)) &&
        ::prctl(PR_SET_PDEATHSIG, SIGKILL, 0, 0, 0) == 0 &&
        ::prctl(PR_SET_DUMPABLE, 0, 0, 0, 0) == 0 && ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0;
    if (!limited) { return Sandbox::Failed; }
    return install_filter() ? Sandbox::Closed : Sandbox::LimitsOnly;
}

}  // namespace relight
