// Who stops waiting for a tree goes at once; what was begun ends behind him, and in good order.
#include "core/trace/builders.h"

#include <array>
#include <atomic>
#include <latch>
#include <new>
#include <set>

#include "tests/trace/model.h"

namespace relight {
namespace {

using namespace test;

TEST(Builders, RunWhatTheyAreGivenAndPassOnWhatItThrows)
{
    Builders builders;
    const Progress progress;
    int runs = 0;
    EXPECT_TRUE(builders.run([&] { ++runs; }, progress));
    EXPECT_EQ(runs, 1);
    EXPECT_THROW(builders.run([] { throw std::bad_alloc(); }, progress), std::bad_alloc);
    EXPECT_TRUE(builders.run([&] { ++runs; }, progress));
    EXPECT_EQ(runs, 2);
}

TEST(Builders, BeginNothingForOneWhoHasStopped)
{
    Builders builders;
    Progress progress;
    progress.stop();
    EXPECT_FALSE(builders.run([] { FAIL(); }, progress));
}

TEST(Builders, LetHimGoWhoStopsBeforeTheWorkIsDoneAndEndItBehindHim)
{
    std::latch may_end(1);
    std::atomic<bool> ended = false;
    {
        Builders builders;
        Progress progress;
        const auto work = [&] {
            progress.stop();
            may_end.wait();
            ended = true;
        };
        EXPECT_FALSE(builders.run(work, progress));
        EXPECT_FALSE(ended);
        may_end.count_down();
    }
    EXPECT_TRUE(ended);
}

TEST(Builders, LetGoOfWhatTheWorkOwnsWhenItEnds)
{
    Builders builders;
    Progress progress;
    auto owned = std::make_shared<int>(1);
    const std::weak_ptr<int> seen = owned;
    std::latch may_end(1);
    EXPECT_FALSE(builders.run(
        [&progress, &may_end, mine = std::move(owned)] {
            progress.stop();
            may_end.wait();
            EXPECT_EQ(*mine, 1);
        },
        progress));
    EXPECT_FALSE(seen.expired());
    may_end.count_down();
    for (int k = 0; k < 5000 && !seen.expired(); ++k) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_TRUE(seen.expired());  // though nobody has asked for anything since
}

TEST(Builders, BeginNothingNewBesideWhatWasLeftBehind)
{
    std::latch may_end(1);
    std::atomic<bool> ended = false;
    Builders builders;
    Progress progress;
    const auto left = [&] {
        progress.stop();
        may_end.wait();
        ended = true;
    };
    EXPECT_FALSE(builders.run(left, progress));
    Progress impatient;
    std::jthread stopper([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        impatient.stop();
    });
    EXPECT_FALSE(builders.run([] { FAIL(); }, impatient));
    may_end.count_down();
    const Progress patient;
    EXPECT_TRUE(builders.run([&] { EXPECT_TRUE(ended); }, patient));
}

TEST(Builders, WorkAtOnceForAllWhoWait)
{
    Builders builders;
    const Progress progress;
    std::latch met(2);  // neither would end if one waited for the other
    std::jthread other([&] { builders.run([&] { met.arrive_and_wait(); }, progress); });
    EXPECT_TRUE(builders.run([&] { met.arrive_and_wait(); }, progress));
}

TEST(Builders, KeepTheirThreads)
{
    Builders builders;
    const Progress progress;
    std::set<std::thread::id> threads;
    for (int k = 0; k < 100; ++k) {
        builders.run([&] { threads.insert(std::this_thread::get_id()); }, progress);
    }
    EXPECT_LT(threads.size(), 10U);
}

TEST(Building, StoppedAtAnyMomentHarmsNothingAndOutlivesItsMesh)
{
    Mesh points = test::grid(320);  // both of enough to be built apart
    points.faces = {};
    for (const Mesh& filed : {test::grid(230), points}) {
        const Surface ready = Model::prepared(filed);
        for (int milliseconds = 0; milliseconds < 40; milliseconds += 4) {
            auto mesh = std::make_shared<const Mesh>(filed);
            auto surface = std::make_shared<const Surface>(ready);
            Progress progress;
            std::jthread stopper([&] {
                std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
                progress.stop();
            });
            const auto quality = milliseconds % 8 == 0 ? TreeQuality::Fast : TreeQuality::Good;
            const Bvh bvh(std::exchange(mesh, nullptr), std::exchange(surface, nullptr), 1.5,
                          quality, progress);
            if (progress.stopped()) { continue; }
            EXPECT_NE(bvh.nearest({0.01, 0.02, 3}, -up).primitive, ~0U);
        }
    }
}

TEST(Building, ByReferenceOrSharedIsTheSame)
{
    const auto mesh = std::make_shared<const Mesh>(test::grid(230));
    const auto surface = std::make_shared<const Surface>(Model::prepared(*mesh));
    Progress progress;
    for (const TreeQuality quality : {TreeQuality::Fast, TreeQuality::Good}) {
        const Bvh shared(mesh, surface, 1.5, quality, progress);
        const Bvh by_reference(*mesh, *surface, 1.5, quality, progress);
        EXPECT_EQ(shared.quality(), quality);
        EXPECT_EQ(shared.bytes(), by_reference.bytes());
        Numbers numbers;
        for (int k = 0; k < 1000; ++k) {
            const Point3 eye{numbers.in(-0.9, 0.9), numbers.in(-0.9, 0.9), 1.0};
            const Hit a = shared.nearest(eye, -up), b = by_reference.nearest(eye, -up);
            EXPECT_EQ(a.primitive, b.primitive);
            EXPECT_EQ(a.distance, b.distance);
        }
    }
}

}  // namespace
}  // namespace relight
