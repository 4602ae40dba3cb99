#pragma once

#include <cstdint>

namespace relight {

struct SandboxLimits {
    std::uint64_t memory = 1ULL << 31U;  ///< of address space [bytes]
    std::uint64_t cpu_seconds = 20;
};

enum class Sandbox {
    Closed,      ///< limits, and nothing but reading and writing what is open already
    LimitsOnly,  ///< the kernel has no seccomp filters, or a sanitizer needs more than they allow
    Failed,      ///< not even limits: do not read what a client sent
};

/// Shuts this process in, for good: bounds of memory and CPU time, no file can be opened or grow,
/// no process or thread started, no privilege gained, no core dumped; it dies with its parent; any
/// system call beyond those of reading, writing and memory kills it. Call it before the first byte
/// of a client's is read, with no other thread running.
Sandbox enter_sandbox(const SandboxLimits& limits);

}  // namespace relight
