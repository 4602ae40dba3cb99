#pragma once

#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstring>
#include <string>
#include <vector>

namespace relight::bench {

// A benchmark's name is what it measures; "… beside Y" is the yardstick Y over the same work. Then
// come the vertices and, where it matters, the threads (0: one a core). tests/bench/table.py pairs
// them. A counter is a rate, named by its unit.

/// The least is for the smoke test; tests/bench/run measures the others.
inline void sizes(benchmark::internal::Benchmark* b)
{
    b->Unit(benchmark::kMillisecond)->UseRealTime()->Arg(1'000)->Arg(100'000)->Arg(1'000'000);
}

inline void sizes_and_threads(benchmark::internal::Benchmark* b)
{
    b->Unit(benchmark::kMillisecond)->UseRealTime();
    b->ArgsProduct({{1'000, 100'000, 1'000'000}, {1, 0}});
}

/// The same where the largest takes seconds: that on all threads alone.
inline void few_sizes_and_threads(benchmark::internal::Benchmark* b)
{
    b->Unit(benchmark::kMillisecond)->UseRealTime();
    b->ArgsProduct({{1'000, 100'000}, {1, 0}})->Args({1'000'000, 0});
}

inline std::size_t vertices(const benchmark::State& state)
{
    return static_cast<std::size_t>(state.range(0));
}
inline unsigned threads(const benchmark::State& state)
{
    return static_cast<unsigned>(state.range(1));
}

/// Each iteration did `amount` of `unit`.
inline void rate(benchmark::State& state, const char* unit, std::size_t amount)
{
    state.counters[unit] = benchmark::Counter(static_cast<double>(amount),
                                              benchmark::Counter::kIsIterationInvariantRate);
}

/// The yardstick of readers and writers: memcpy of a file, over a copy that is there already.
inline void copy(benchmark::State& state, const std::string& file)
{
    std::vector<char> copied(file.size());
    while (state.KeepRunning()) {
        std::memcpy(copied.data(), file.data(), file.size());
        benchmark::ClobberMemory();
    }
    rate(state, "bytes", file.size());
}

/// The same to memory that is asked for each time, as a reader's and a writer's arrays are.
inline void copy_afresh(benchmark::State& state, const std::string& file)
{
    while (state.KeepRunning()) {
        const std::vector<char> copied(file.begin(), file.end());
        benchmark::DoNotOptimize(copied.data());
    }
    rate(state, "bytes", file.size());
}

}  // namespace relight::bench
