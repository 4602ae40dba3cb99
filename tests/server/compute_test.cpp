#include "server/compute.h"

#include <gtest/gtest.h>

#include <latch>

namespace relight {
namespace {

using std::chrono::milliseconds;

TEST(ComputePool, GivesBackWhatTheWorkReturnsOrThrows)
{
    ComputePool pool(2, 4);
    EXPECT_EQ(*pool.run([](Progress&) -> Result<int> { return 42; }), 42);
    EXPECT_THROW(static_cast<void>(
                     pool.run([](Progress&) -> Result<int> { throw std::runtime_error("x"); })),
                 std::runtime_error);
    EXPECT_EQ(*pool.run([](Progress&) -> Result<int> { return 43; }), 43) << "it lives on";
}

TEST(ComputePool, RefusesAtOnceWhenTheQueueIsFull)
{
    ComputePool pool(1, 1);
    std::latch started(1);
    std::latch go(1);
    ASSERT_TRUE(pool.submit([&](Progress&) {
        started.count_down();
        go.wait();
    }));
    started.wait();
    ASSERT_TRUE(pool.submit([](Progress&) {}));
    const auto refused = pool.run([](Progress&) -> Result<int> { return 1; });
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().fault, Fault::Overloaded);
    EXPECT_FALSE(pool.idle_within(milliseconds(1)));
    go.count_down();
    EXPECT_TRUE(pool.idle_within(milliseconds(10'000)));
}

TEST(ComputePool, StopsWhatRunsAndDropsWhatWaits)
{
    ComputePool pool(1, 4);
    std::latch started(1);
    ASSERT_TRUE(pool.submit([&](Progress& progress) {
        started.count_down();
        while (!progress.stopped()) { std::this_thread::yield(); }
    }));
    started.wait();
    auto waiting = std::async(std::launch::async,
                              [&] { return pool.run([](Progress&) -> Result<int> { return 1; }); });
    std::this_thread::sleep_for(milliseconds(50));  // it may also come too late: then it runs
    pool.stop_all();
    const auto answer = waiting.get();
    EXPECT_TRUE(answer || answer.error().fault == Fault::Stopping);
    EXPECT_TRUE(pool.idle_within(milliseconds(10'000)));
}

}  // namespace
}  // namespace relight
