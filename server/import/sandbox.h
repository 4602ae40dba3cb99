#pragma once

#include <cstdint>

namespace relight {

struct SandboxLimits {
    std::uint64_t memory = 1ULL << 31U;  ///< of address space [bytes]
    std::uint64_t output = 1ULL << 31U;  ///< how long a file may become by writing [bytes]
    std::uint64_t cpu_seconds = 20;
};

enum class Sandbox {
    Closed,      ///< limits, and nothing but memory and writing to what is open already
    LimitsOnly,  ///< the kernel has no seccomp filters, or a sanitizer needs more than they allow
    Failed,      ///< not even limits: do not read what a client sent
};

/// Shuts this process in, for good: bounds of memory, output and CPU time, no file can be opened,
/// no process or thread started, no privilege gained, no core dumped; it dies with its parent; any
/// system call beyond those of writing and memory kills it: not even reading is left. Call it
/// before the first byte of a client's is looked at, with no other thread running.
Sandbox enter_sandbox(const SandboxLimits& limits);

}  // namespace relight
